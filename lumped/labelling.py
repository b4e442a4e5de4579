"""Datasets whose variables have units and plain names, with attributes about their origin."""

from __future__ import annotations

import hashlib
import platform
from collections.abc import Mapping
from functools import cache
from importlib import metadata, resources
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    import xarray as xr

_OWN = ("lumped", "multibody", "floquet", "validation")
_SUFFIXES = frozenset({".py", ".toml", ".html", ".css", ".js"})
#: Dimensions, values, unit ("1" for none), plain name.
Variable = tuple[str | tuple[str, ...], Any, str, str]
#: Values along the dimension of the coordinate's own name, unit, plain name.
Coordinate = tuple[Any, str, str]


class Described(Protocol):
    """The part of a gear pair that ``provenance`` reads."""

    @property
    def name(self) -> str:
        """Short name."""

    @property
    def stiffness_words(self) -> str:
        """Words: the stiffness of the whole mesh, or of one tooth pair, and its model."""

    def to_toml(self) -> str:
        """All parameters."""


def labelled_dataset(
    variables: Mapping[str, Variable],
    coordinates: Mapping[str, Coordinate],
    attributes: Mapping[str, Any] | None = None,
) -> xr.Dataset:
    """Return arrays as a dataset with names, units and dimensions, and with the versions of the program."""
    import xarray as xr  # takes a third of a second, which an import of the package should not

    return xr.Dataset(
        {
            name: (dims, values, {"units": unit, "long_name": text})
            for name, (dims, values, unit, text) in variables.items()
        },
        coords={
            name: (name, values, {"units": unit, "long_name": text})
            for name, (values, unit, text) in coordinates.items()
        },
        attrs={"versions": _versions()} | dict(attributes or {}),
    )


def provenance(pair: Described, **settings: Any) -> dict[str, Any]:
    """Return the attributes about the origin of a result: parameters, hash, versions, settings."""
    text = pair.to_toml()
    return {
        "gear_pair": pair.name,
        "parameters": text,
        "parameters_sha256": _sha256(text),
        "stiffness": pair.stiffness_words,
        "teeth": "alike",
        "versions": _versions(),
        "settings": ", ".join(f"{key}={value}" for key, value in sorted(settings.items())),
    }


@cache
def _versions() -> str:
    names = ("spurcheck", "numpy", "scipy", "exudyn")
    versions = [f"{name} {metadata.version(name)}" for name in names]
    return ", ".join([f"python {platform.python_version()}", *versions])


def parameters_hash(pair: Described) -> str:
    """SHA-256 of the pair's TOML text: the same parameters give the same hash everywhere."""
    return _sha256(pair.to_toml())


def _sha256(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()


@cache
def source_hash() -> str:
    """SHA-256 of the names and contents of all files of the four packages, which changes with every edit."""
    digest = hashlib.sha256()
    for package in _OWN:
        root = Path(str(resources.files(package)))
        for path in sorted(p for p in root.rglob("*") if p.suffix in _SUFFIXES):
            digest.update(f"{package}/{path.relative_to(root).as_posix()}\0".encode())
            digest.update(path.read_bytes() + b"\0")
    return digest.hexdigest()

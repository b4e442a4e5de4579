"""Versions and hashes: what made this report."""

from __future__ import annotations

import hashlib
import platform
from functools import cache
from importlib import metadata, resources
from pathlib import Path

from lumped.labelling import parameters_hash
from validation.reporting.blocks import Content, Table, Text, facts
from validation.reporting.chapter import Chapter
from validation.reporting.results import Results

_OWN = ("lumped", "multibody", "floquet", "validation")
_SUFFIXES = frozenset({".py", ".toml", ".html", ".css", ".js"})
_PACKAGES = ("spurcheck", "numpy", "scipy", "numba", "exudyn", "control", "xarray", "matplotlib")


def write(results: Results) -> Content:
    """Write the chapter."""
    effort = results.effort
    made = facts(
        "made_from",
        ("parameters_sha256", "SHA-256 of the parameters", parameters_hash(results.pair)),
        ("source_sha256", "SHA-256 of the program's source", source_hash()),
        ("samples", "samples per mesh cycle", results.effort.samples),
        ("cycles", "mesh cycles of the cross-check", effort.cycles),
        ("sweep_speeds", "speeds of the response", effort.sweep_speeds),
        ("chart_nodes", "nodes of the stability chart", effort.chart_speeds * effort.chart_dampings),
        ("chart_rtol", "tolerance of the chart", effort.chart_rtol),
    )
    versions = Table(
        "versions",
        "Software.",
        {"name": "name", "version": "version"},
        (
            ("python", platform.python_version()),
            ("platform", f"{platform.system()} {platform.machine()}"),
            *((name, metadata.version(name)) for name in _PACKAGES),
        ),
    )
    text = Text(
        "The same parameters and software give the same report.json, byte for byte, apart from its "
        "timestamps block, on processors of one type with as many threads of BLAS (the command takes one); "
        "others may differ in the last digits. The folder beside this page holds every figure (figures/, "
        "SVG), the data behind them (data/, NetCDF) and the parameter file that reproduces the report "
        "(data/parameters.toml)."
    )
    return Content((text, made, versions))


@cache
def source_hash() -> str:
    """SHA-256 over names and contents of the four packages' files: says more than a version does."""
    digest = hashlib.sha256()
    for package in _OWN:
        root = Path(str(resources.files(package)))
        for path in sorted(p for p in root.rglob("*") if p.suffix in _SUFFIXES):
            digest.update(f"{package}/{path.relative_to(root).as_posix()}\0".encode())
            digest.update(path.read_bytes() + b"\0")
    return digest.hexdigest()


CHAPTER = Chapter("provenance", "Versions and hashes", write)

"""Docstrings that tell a reader where something is computed name only what exists."""

import importlib
import re

import pytest

import lumped

#: Modules whose docstring is an index of other places.
INDEXES = [
    "lumped.losses",
    "lumped.mesh.element",
    "lumped.mesh.unilateral_force",
    "lumped.model.linear_or_unilateral",
    "lumped.model.period_closure",
]
PACKAGES = ("lumped.", "multibody.", "floquet.", "validation.", "spurcheck.")


def resolve(name):
    """Return the object of a dotted name. A name without a package is relative to ``lumped``."""
    parts = (name if name.startswith(PACKAGES) else f"lumped.{name}").split(".")
    for length in range(len(parts), 0, -1):
        try:
            result = importlib.import_module(".".join(parts[:length]))
        except ModuleNotFoundError:
            continue
        for attribute in parts[length:]:
            result = getattr(result, attribute)
        return result
    raise ModuleNotFoundError(name)


@pytest.mark.parametrize("module", INDEXES)
def test_an_index_names_what_exists(module):
    text = importlib.import_module(module).__doc__
    names = [name for name in re.findall(r"``([\w.]+)``", text) if "." in name]
    assert len(names) >= 2
    for name in names:
        resolve(name)


def test_a_name_that_does_not_exist_is_seen():
    assert resolve("losses.loss_factor.ohlendorf") is lumped.losses.ohlendorf
    with pytest.raises((AttributeError, ModuleNotFoundError)):
        resolve("lumped.mesh.damper.no_such_power")
    with pytest.raises((AttributeError, ModuleNotFoundError)):
        resolve("nowhere.at.all")

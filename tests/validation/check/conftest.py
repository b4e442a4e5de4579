"""Checks of the same pair share its two motions."""

import importlib

import pytest

from tests.validation.check import motions
from tests.validation.check.sampled_motions import pairs_of_cases


@pytest.fixture(autouse=True)
def shared_motions(monkeypatch):
    """Let ``check`` take motions of pairs that were computed before; it only reads them."""
    check = importlib.import_module("validation.check.check")
    for name in ("lumped_motion", "multibody_motion"):
        monkeypatch.setattr(check, name, getattr(motions, name))


@pytest.fixture(scope="module")
def pairs():
    """Name -> pair of the cases of explanations."""
    return pairs_of_cases()


@pytest.fixture(scope="module")
def shared():
    """Name of a pair -> motions of its changed models."""
    return {}

"""Fixtures of the cross-check, report and command tests."""

import pytest

import lumped
from validation.cross_check.comparison import crosscheck


@pytest.fixture(scope="session")
def pair():
    """The default pair with involute flanks; with its relief contact is lost."""
    return lumped.load_gear_pair("nasa_28_28").with_(mesh__contact="prescribed", mesh__relief="ignored")


@pytest.fixture(scope="session")
def fractions():
    """Fractions of progress that the shared cross-check announced."""
    return []


@pytest.fixture(scope="session")
def check(pair, fractions):
    """Cross-check of the default pair, shared because it is only read."""
    return crosscheck(pair, cycles=24, samples_per_cycle=128, progress=lambda f, _="", /: fractions.append(f))

"""The default pair."""

import pytest

import lumped


@pytest.fixture(scope="session")
def pair():
    """With involute flanks: with its relief contact is lost."""
    return lumped.load_gear_pair("nasa_28_28").with_(mesh__contact="prescribed", mesh__relief="ignored")

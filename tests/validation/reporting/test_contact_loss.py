"""Does a report whose linear motion needs teeth that pull say what the pair does instead?"""

from __future__ import annotations

import pytest

import floquet
import lumped
from validation.reporting.chapters import contact_loss
from validation.reporting.results import QUICK, Results
from validation.reporting.words import motion, parted


@pytest.fixture(scope="module")
def results():
    return Results(lumped.load_gear_pair("nasa_28_28"), QUICK)


def test_the_first_page_says_the_motion_of_teeth_that_push(results):
    """The linear motion is 1.6 % off the multibody model by its root mean square; this one a tenth of it."""
    orbit = floquet.periodic_orbit(results.pair)
    low, high = orbit.dte_range
    assert f"{1e6 * (high - low):.2f}" in parted(results)
    assert parted(results) in motion(results)
    assert high - low == pytest.approx(results.parting.exact_peak_to_peak, rel=5e-3)
    assert results.parting.exact.sizes["time"] < results.motion.sizes["time"] * 2 + 2
    exact = results.parting.exact["dte"].to_numpy()
    assert orbit.dte_rms == pytest.approx(exact.std(), rel=3e-3)
    assert results.motion["dte"].to_numpy().std() != pytest.approx(exact.std(), rel=1e-2)


def test_the_chapter_is_there_only_where_teeth_part(results):
    content = contact_loss.write(results)
    assert {getattr(block, "key", None) for block in content.blocks} >= set(contact_loss.CHAPTER.front)
    held = Results(results.pair.with_(mesh__relief="ignored"), QUICK)
    assert held.parting is None
    assert contact_loss.write(held) is None
    assert parted(held) == ""

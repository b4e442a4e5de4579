"""Chapter "Are four springs enough?": both answers, and what makes it doubt its own reference."""

import dataclasses

import numpy as np
import pytest

import lumped
from validation.reporting.chapters.four_springs import CHAPTER
from validation.reporting.formatting import quantity
from validation.reporting.results import Results
from validation.reporting.words import on_shafts
from validation.validity.flags import supports
from validation.validity.four_springs import LIMITS, four_springs


def _on(pair, diameter, length, places, stiffness):
    """The pair in the middle of two equal shafts."""
    shaft = {
        "segments": [{"length": length, "diameter": diameter}],
        "gear_position": 0.25 * length,
        "bearings": [
            {"position": place, "loa_stiffness": stiffness, "oloa_stiffness": stiffness} for place in places
        ],
    }
    return pair.with_(shafts={"damping_ratio": 0.02, "pinion": shaft, "gear": shaft})


@pytest.fixture(scope="module")
def slender(pair, tiny):
    """Results of slender shafts that overhang."""
    few = dataclasses.replace(tiny, shaft_speeds=3)
    return Results(_on(pair, 30, 240, (0, 120), 5e8), few)


@pytest.fixture(scope="module")
def stiff(pair, tiny):
    """Results of short, stiff and light shafts, each in one bearing with its gear's springs and dampers."""
    shafts = {"damping_ratio": 0}
    for name in ("pinion", "gear"):
        springs, mass = getattr(pair.bearings, name), getattr(lumped.bodies(pair), f"mass_{name}")
        bearing = {"position": 10, "tilt_stiffness": 1e7}
        for d in ("loa", "oloa"):
            stiffness, ratio = getattr(springs, f"{d}_stiffness"), getattr(springs, f"{d}_damping_ratio")
            bearing |= {f"{d}_stiffness": stiffness, f"{d}_damping": 2 * ratio * np.sqrt(stiffness * mass)}
        shafts[name] = {
            "segments": [{"length": 20, "diameter": 40}], "gear_position": 10, "bearings": [bearing],
            "youngs_modulus": 2000, "density": 10,
        }  # fmt: skip
    return Results(pair.with_(shafts=shafts), dataclasses.replace(tiny, shaft_speeds=3))


def test_slender_shafts_are_no_springs(slender):
    found = slender.four_springs
    assert found.off_here("springs") > LIMITS[1]
    assert supports(found).state == "violated"
    speeds = found.over_speed["speed"].to_numpy()
    ends = sorted([*found.ranges(hold=True), *found.ranges(hold=False)])
    assert [low for low, _ in ends] + [speeds[-1]] == [speeds[0]] + [high for _, high in ends]
    for speed, off in zip(speeds, found.off("springs"), strict=True):
        assert any(low <= speed <= high for low, high in found.ranges(hold=off <= LIMITS[1]))
    content = CHAPTER.write(slender)
    assert content.badge.state == "violated"
    assert "not enough here" in content.blocks[0].text
    assert set(CHAPTER.front) <= {getattr(block, "key", None) for block in content.blocks}


def test_short_and_stiff_shafts_are_springs(stiff):
    found = stiff.four_springs
    for model in ("springs", "condensed"):
        assert found.off(model).max() < 0.02, model  # the shafts weigh a thousandth of the gears
    assert supports(found).state == "ok"
    assert found.ranges(hold=False) == []
    low, high = found.over_speed["speed"].to_numpy()[[0, -1]]
    assert found.ranges(hold=True) == [(low, high)]
    assert CHAPTER.write(stiff).badge.state == "confirmed"
    assert f"at all speeds from {low:.0f} to {high:.0f} rpm" in CHAPTER.write(stiff).blocks[0].text


def test_springs_that_the_shafts_contradict_are_off_and_condensed_ones_are_not(stiff):
    wrong = stiff.pair.with_(bearings__pinion__loa_stiffness=3 * stiff.pair.bearings.pinion.loa_stiffness)
    found = four_springs(wrong, [stiff.operating_rpm])
    assert found.off_here("springs") > LIMITS[1]
    assert found.off_here("condensed") < 0.02  # as above


def test_the_chapter_doubts_a_reference_that_the_machine_does_not_confirm(stiff, monkeypatch):
    (check,) = stiff.on_shafts
    assert check.passes
    assert check in stiff.checks  # a failure is among the first words of the report
    monkeypatch.setattr(stiff, "on_shafts", (dataclasses.replace(check, value=2 * check.limit),))
    content = CHAPTER.write(stiff)
    assert content.badge.state == "not confirmed"
    assert "does not have the motion" in content.blocks[0].text


def test_without_shafts_there_is_no_chapter(pair, tiny):
    results = Results(pair, tiny)
    assert results.four_springs is None
    assert results.on_shafts == ()
    assert CHAPTER.write(results) is None


def test_page_1_states_the_transmission_error_on_the_shafts(slender, stiff):
    """Of slender shafts that four springs do not stand for; the number of the chapter's table."""
    span = slender.four_springs.here("shafts", "dte")
    assert on_shafts(slender) == f" On its shafts: {quantity(span, 'm', 3)} peak to peak."
    assert on_shafts(stiff) == ""

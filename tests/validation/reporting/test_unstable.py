"""Does a report of an unstable motion say so wherever it shows that motion?"""

import numpy as np
import pytest

import lumped
from lumped.model.steady import UNSTABLE
from validation.plots.motion import sweep_figure
from validation.reporting.build import document, written
from validation.reporting.chapters import CHAPTERS
from validation.reporting.chapters.steady_state import off_line_modes
from validation.reporting.gate import failures


@pytest.fixture(scope="module")
def unstable(pair, no_variant, sharing):
    """Results in the widest tongue of the default pair: largest multiplier 1.29 without mesh damping.

    As if unilateral contact had no stable motion there. Margins over all speeds and other forms of contact
    do not tell this motion.
    """
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr("validation.cross_check.comparison.unilateral_orbit", lambda pair: (None, ""))
        there = pair.with_({"operating.pinion_speed": "17000 rpm", "mesh.damping_ratio": 0.0})
        results = sharing(there, ("margins",))
        results.forms = "Not asked."
        yield results


@pytest.fixture(scope="module")
def data(unstable):
    asked = ("steady_state", "cross_check", "stability", "validity", "losses")
    chapters = tuple(chapter for chapter in CHAPTERS if chapter.key in asked)
    return document(unstable, written(unstable, chapters), quick=True)


def test_the_verdicts_that_fail_are_named(data):
    named = {line.split(": ")[1] for line in failures(data)}
    assert named >= {"Is the motion stable?", "Periodic motion is stable"}


def test_every_chapter_on_the_motion_warns(data):
    first = data["verdict"].split(". ")[0]
    assert first.startswith("Do not rely on this prediction: ")
    assert "the periodic motion is unstable" in first
    assert "the prediction holds" not in data["verdict"]
    prediction = data["answers"][0]
    assert prediction["verdict"] == {"state": "violated", "text": "not reliable"}
    assert prediction["text"].startswith("Computed, but not what a gear pair would show: ")
    for key in ("steady_state", "losses", "cross_check"):
        assert data["chapters"][key]["text"][0][0].startswith("Warning: the periodic motion"), key
    motion = data["chapters"]["steady_state"]["key_results"]["stability"]
    assert motion["value"]["state"] == "unstable"
    assert "1.28" in motion["note"]


def test_the_sweep_counts_unstable_speeds_and_names_no_peak_among_them(data, unstable):
    facts = data["chapters"]["steady_state"]["over_speed"]
    speeds, radii = (unstable.sweep[name].to_numpy() for name in ("speed", "spectral_radius"))
    here = radii > UNSTABLE
    widths = np.diff(speeds)  # each speed stands for half of the intervals beside it
    share = (0.5 * widths * (here[1:].astype(float) + here[:-1])).sum() / widths.sum()
    assert 0.0 < share == pytest.approx(facts["share_unstable"]["value"], rel=1e-12)
    peak = facts["speed_of_largest"]["value"]["value"]
    assert radii[np.argmin(np.abs(speeds - peak))] < UNSTABLE
    assert facts["speed_of_largest"]["note"] == "among stable motions"


def test_the_sweep_figure_crosses_unstable_motions_out(pair):
    sweep = lumped.speed_sweep(pair.with_({"mesh.damping_ratio": 0.0}), [4000, 17000], samples_per_cycle=16)
    figure = sweep_figure(sweep, 4000.0, 1000.0)
    crosses = [line for line in figure.axes[0].lines if line.get_marker() == "x"]
    assert [line.get_xdata().tolist() for line in crosses] == [[17000.0]]


def test_equal_gears_have_three_modes_of_one_frequency_of_which_two_are_off_the_line(pair):
    # x_p = x_g moves no tooth: its frequency is that of the bearings, which here are alike in x and y.
    found = lumped.model.averaged.modes(pair)
    frequency = np.sqrt(1e8 / lumped.bodies(pair).mass_pinion) / (2 * np.pi)
    same = [mode for mode in found if abs(mode.natural_frequency / frequency - 1) < 1e-9]
    assert len(same) == 3
    places = off_line_modes(pair, found)
    assert len(places) == 2
    # With softer bearings off the line the two are told by frequency.
    soft = pair.with_(
        {"bearings.pinion.oloa_stiffness": 2e7, "bearings.gear.oloa_stiffness": 3e7, "pinion.mass": 0.5}
    )
    found = lumped.model.averaged.modes(soft)
    chosen = sorted(found[k].natural_frequency for k in off_line_modes(soft, found))
    expected = sorted(
        np.sqrt(k / m) / (2 * np.pi) for k, m in ((2e7, 0.5), (3e7, lumped.bodies(soft).mass_gear))
    )
    np.testing.assert_allclose(chosen, expected, rtol=1e-9)

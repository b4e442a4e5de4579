"""Does a report whose linear motion has negative tooth loads say what the pair does instead?"""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest

import floquet
import lumped
import multibody
from floquet.gear.jump_map import JumpRemoval
from validation.reporting import words
from validation.reporting.blocks import Text
from validation.reporting.chapters import contact_loss
from validation.reporting.results import Results
from validation.validity.beyond_contact_loss import jumps_about_operation
from validation.validity.contact_forms import contact_forms


@pytest.fixture(scope="module")
def results(no_variant, tiny):
    return Results(lumped.load_gear_pair("nasa_28_28"), tiny)


def test_the_first_page_says_the_motion_with_unilateral_contact(results):
    """The linear motion is 1.6 % off the multibody model by its root mean square; this one 3e-4."""
    orbit = floquet.periodic_orbit(results.pair)
    low, high = orbit.dte_range
    assert results.contact_loss.judged
    assert "unilateral contact do" in words.headline(results)
    assert f"{1e6 * (high - low):.2f}" in words.motion(results)
    assert "fades to 80" in words.stability(results)
    assert high - low == pytest.approx(results.contact_loss.exact_peak_to_peak, rel=1e-3)
    exact = results.contact_loss.exact["dte"].to_numpy()
    assert orbit.dte_rms == pytest.approx(exact.std(), rel=1e-3)
    assert results.motion["dte"].to_numpy().std() != pytest.approx(exact.std(), rel=1e-2)
    powers = -orbit.motion["friction_power"].sum("pair").to_numpy().mean()
    loss = powers / (results.pair.operating.pinion_torque * results.geometry.omega_pinion)
    assert f"{100 * loss:.2g}" in words.motion(results)


def test_page_1_judges_prescribed_contact_by_the_exact_contact_and_says_its_residual(results):
    """Also here, where prescribed contact is off by less than a tenth and the first words pass over that."""
    told, pair = words.agreement(results), results.pair.with_(mesh__contact="loaded")
    exact, loaded = (model.steady_state(pair, samples_per_cycle=512) for model in (multibody, lumped))
    paper = lumped.steady_state(results.pair, samples_per_cycle=512)
    swing = np.ptp(exact["dte"].to_numpy())
    off = (abs(one["dte"] - exact["dte"]).max() / swing for one in (paper, loaded))
    paper_off, loaded_off = (f"by up to {100 * float(one):.2g}\u00a0%" for one in off)
    assert words.contact_off(results) == ""
    assert f"gives {1e6 * swing:.2f}\u00a0µm peak to peak" in told
    assert f"loaded contact gives {1e6 * loaded.attrs['dte_peak_to_peak']:.2f}\u00a0µm" in told
    assert told.index(paper_off) < told.index("loaded contact") < told.index(loaded_off)
    assert f"energy residual of {paper.attrs['power_energy_residual']:.2f}\u00a0W" in told


def test_a_motion_that_is_refuted_or_not_compared_is_no_prediction(results, monkeypatch):
    """Then the first words say why, and the violated assumption is among the reasons."""
    monkeypatch.setattr(
        results, "check", dataclasses.replace(results.check, orbit=None, conservation=()), raising=False
    )
    unjudged = dataclasses.replace(results.contact_loss, judged=False)
    monkeypatch.setattr(results, "contact_loss", unjudged, raising=False)
    assert words.headline(results).startswith("Do not rely on this prediction")
    assert "teeth stay in contact" in words.headline(results)
    assert words.with_unilateral_contact(results) in words.motion(results)


def test_the_chapter_is_there_only_with_contact_loss(results):
    content = contact_loss.write(results)
    assert "contact_loss" in {getattr(block, "key", None) for block in content.blocks}
    held = Results(results.pair.with_(mesh__relief="ignored"), results.effort)
    assert held.contact_loss is None
    assert contact_loss.write(held) is None
    assert words.with_unilateral_contact(held) == ""


def test_the_chapter_says_which_motion_is_compared(results, monkeypatch):
    """Loaded 28/28: one pair pulls by 216 N, but with the other it presses by 900 N all the time."""
    said = {block.text for block in contact_loss.write(results).blocks if isinstance(block, Text)}
    assert any(text.endswith("compares this motion.") for text in said)
    loaded = Results(results.pair.with_(mesh__contact="loaded"), results.effort)
    unjudged = dataclasses.replace(results.contact_loss, judged=False)
    monkeypatch.setattr(loaded, "contact_loss", unjudged, raising=False)
    assert "never negative" in contact_loss._compared(loaded)
    # That pair makes the linear motion a tenth wrong; with pairs that push only a hundredth is left.
    forms = contact_forms(loaded.pair, 128)
    monkeypatch.setattr(loaded, "forms", forms, raising=False)
    orbit = floquet.periodic_orbit(loaded.pair)
    monkeypatch.setattr(loaded, "contact_loss", dataclasses.replace(unjudged, orbit=orbit), raising=False)
    assert forms.off(loaded.lifting) < 0.02 < 0.1 < forms.difference["loaded"]
    assert words.contact_off(loaded).startswith("one tooth pair lifts off while another carries")
    monkeypatch.setattr(results, "contact_loss", unjudged, raising=False)
    assert "only where it is stable" in contact_loss._compared(results)


def test_the_chapter_tells_jumps_and_what_removes_them(results, monkeypatch):
    """28/28 without relief and friction: folds at 7596 and 7723 rpm; tests/floquet/gear removes them."""
    pair = results.pair.with_(mesh__relief="ignored", friction__law="none")
    pair = pair.with_({"operating.pinion_speed": 7660.0, "mesh.damping_ratio": 0.05})
    told = Results(pair, results.effort)
    monkeypatch.setattr(told, "contact_loss", None, raising=False)
    found = floquet.response_branches(pair, (7400.0, 7900.0), (1,), seeds=0)
    monkeypatch.setattr(told, "branches", found, raising=False)
    removal = JumpRemoval("damping_ratio", "larger", 0.05, 1.0, 0.0547, 1e-5, 7660.0)
    nothing = dataclasses.replace(removal, direction="smaller", value=math.nan)
    monkeypatch.setattr(
        contact_loss,
        "jumps_removed_by",
        lambda _, axis: (nothing, removal) if axis == removal.axis else (nothing,),
    )
    jumping = jumps_about_operation(pair, (0.98, 1.02), (2, 9))
    monkeypatch.setattr(told, "jump_map", jumping, raising=False)
    assert jumping["jump_speed_rpm"].to_numpy() == pytest.approx([7596.3, 7723.1] * 2, abs=0.1)
    content = contact_loss.write(told)
    blocks = {getattr(block, "key", None): block for block in content.blocks}
    assert {"response", "jumps", "jump_map"} <= blocks.keys()
    assert "several stable motions at 33" in str(content.blocks)
    monkeypatch.setattr(told, "jump_map", jumps_about_operation(results.pair, (0.99, 1.0), (2, 2)))
    content = contact_loss.write(told)
    assert "one stable motion everywhere" in str(content.blocks)
    text = " ".join(str(block) for block in content.blocks)
    assert "with a damping ratio of the mesh above 0.0547." in text
    assert "7723" in words.jumps(told) or "7596" in words.jumps(told)
    assert "the largest of 2 jumps" in words.jumps(told)
    assert "beats" not in words.jumps(told)
    beating = pair.with_({"operating.pinion_speed": 13800.0})
    found = floquet.response_branches(beating, (13700.0, 13900.0), (1,), seeds=0)
    monkeypatch.setattr(told, "branches", found, raising=False)
    assert "at 13700 to 13900" in words.jumps(told)
    assert "there it beats, is chaotic" in words.jumps(told)

"""Do the effect switches say why the models differ?"""

import numpy as np
import pytest
import xarray as xr

import lumped
import multibody
from multibody.run.effects import (
    CAUSES,
    DEFAULT_EFFECTS,
    EFFECTS,
    active_effects,
    default_effects,
    effect_flags,
)
from multibody.study import causes

JUMPS = lumped.load_gear_pair("nasa_28_28").with_(
    mesh__contact="prescribed", mesh__relief="ignored", friction__law="coulomb", friction__coefficient=0.05
)
SMOOTH = JUMPS.with_(mesh__stiffness={"model": "parabolic", "ramp_length": 3.0})


@pytest.mark.slow
def test_causes_of_the_difference():
    """With smooth stiffness the actual sliding velocity is the cause; jumps add the shift of tooth entry.

    Without friction there is no sliding to matter, and every cause that is left is far smaller.
    """
    smooth = multibody.attribution(SMOOTH)
    assert smooth.attrs["largest"] == "sliding_velocity"
    dte = smooth["alone"].sel(quantity="dte")
    assert float(dte.sel(cause="sliding_velocity")) == pytest.approx(float(dte.sel(cause="all")), rel=0.02)
    assert float(dte.sel(cause="entry_shift")) < 1e-5
    jumps = multibody.attribution(JUMPS)["alone"].sel(quantity="dte")
    assert float(jumps.sel(cause="entry_shift")) > 100 * float(dte.sel(cause="entry_shift"))
    still = multibody.attribution(SMOOTH.with_(friction__law="none"))["alone"]
    assert float(still.sel(cause="all", quantity="dte")) < 0.05 * float(dte.sel(cause="all"))
    assert np.isnan(still.sel(cause="all", quantity="y_p"))


#: What each effect adds to every quantity of a made-up motion of span 10: all sums differ.
MADE_UP = {
    "rotation_phase": 1.0, "moving_line": 2.0, "sliding_velocity": -4.0, "entry_shift": 0.5,
    "contact_loss": 0.25, "friction_load": 30.0, "path_work": 40.0, "tip_contact": 50.0, "clearance": 60.0,
    "neighbours": 0.5, "contact_law": 70.0,
}  # fmt: skip


def test_changes_alone_and_without_are_told_apart(monkeypatch):
    """Effects that simply add: alone is the own part, without is the rest, each over the motion's span."""

    def motion(effects, samples):
        # The largest change is at one time only, with either sign.
        values = np.array([0.0, 10.0, 5.0 + sum(MADE_UP[name] for name in effects)])
        return xr.Dataset(dict.fromkeys(("dte", "x_p", "y_p", "theta_p"), ("time", values)))

    monkeypatch.setattr(
        "multibody.study.causes.prepare", lambda pair, fidelity, initial, effects, rtol: effects
    )
    monkeypatch.setattr("multibody.study.causes.find_orbit", lambda effects, *, near: effects)
    monkeypatch.setattr("multibody.study.causes.cycles_of", motion)
    loaded = multibody.attribution(JUMPS.with_(mesh__contact="loaded")).sel(quantity="x_p")
    every = sum(MADE_UP[name] for name in default_effects("loaded"))
    in_contact = ("entry_shift", "contact_loss", "contact_energy")
    contact = sum(MADE_UP[name] for name, effect in EFFECTS.items() if effect.cause in in_contact)
    assert not {"entry_shift", "contact_loss"} & set(loaded["cause"].values)
    for cause, alone, without in (
        ("contact_energy", contact, np.nan),  # without it there is no exact contact
        ("contact_position", 3.0, every - 3.0),
        ("path_work", 40.0, every - 40.0),
        ("friction_load", 30.0, np.nan),
        ("all", every, 0.0),
    ):
        at = loaded.sel(cause=cause)
        expected = np.array([alone, without]) / 10.0
        np.testing.assert_allclose([at["alone"], at["without"]], expected, err_msg=cause)
    assert loaded.attrs["largest"] == "contact_energy"
    found = multibody.attribution(JUMPS).sel(quantity="x_p")
    total = sum(MADE_UP[name] for name in DEFAULT_EFFECTS)
    assert set(CAUSES) - set(found["cause"].values) == {"contact_energy", "path_work"}
    for cause in found["cause"].values[:-1]:
        own = sum(MADE_UP[name] for name, effect in EFFECTS.items() if effect.cause == cause)
        assert float(found["alone"].sel(cause=cause)) == pytest.approx(abs(own) / 10.0), cause
        expected = np.nan if cause == "friction_load" else abs(total - own) / 10.0
        assert float(found["without"].sel(cause=cause)) == pytest.approx(expected, nan_ok=True), cause
    assert float(found["alone"].sel(cause="all")) == pytest.approx(abs(total) / 10.0)
    assert found.attrs["largest"] == "friction_load"


@pytest.mark.parametrize("contact", ["prescribed", "loaded"])
def test_no_teeth_pull_over_a_gap_and_the_largest_change_is_named(contact, monkeypatch):
    """The 28/28 pair loses contact: without contact loss its exact contact would pull with 364 N."""
    runs = []

    def cycles_of(orbit, samples):
        runs.append(causes_cycles_of(orbit, samples))
        return runs[-1]

    causes_cycles_of = causes.cycles_of
    monkeypatch.setattr(causes, "cycles_of", cycles_of)
    result = multibody.attribution(lumped.load_gear_pair("nasa_28_28").with_(mesh__contact=contact))
    for run in runs:
        if "clearance" in run.attrs["effects"] or "contact_loss" in run.attrs["effects"]:
            assert float(run["normal_load"].min()) >= 0.0, run.attrs["effects"]
    alone = result["alone"].sel(quantity="dte").drop_sel(cause="all")
    assert result.attrs["largest"] == str(alone["cause"][int(alone.to_numpy().argmax())].item())
    assert float(alone.max()) < 0.2


def test_every_cause_has_an_effect():
    assert {effect.cause for effect in EFFECTS.values()} == set(CAUSES)


def test_flags_name_the_effects():
    for name in EFFECTS:
        assert active_effects(effect_flags({name})) == (name,)
        assert active_effects(effect_flags({name: False})) == tuple(n for n in DEFAULT_EFFECTS if n != name)
    further = {name: True for name in EFFECTS if name not in DEFAULT_EFFECTS}
    assert active_effects(effect_flags(further)) == tuple(EFFECTS)
    assert set(active_effects(effect_flags(None, "loaded"))) == set(EFFECTS) - {"friction_load"}
    assert active_effects(effect_flags(None)) == DEFAULT_EFFECTS
    assert effect_flags(()) == 0

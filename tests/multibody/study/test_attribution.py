"""Do the effect switches say why the models differ?"""

import tomllib

import numpy as np
import pytest
import xarray as xr

import lumped
import multibody
from multibody.run.effects import CAUSES, EFFECTS, active_effects, default_effects, effect_flags
from multibody.study import causes
from validation.exchange.new_pair_file import new_pair_text

JUMPS = lumped.load_gear_pair("nasa_28_28").with_(
    mesh__contact="prescribed", mesh__relief="ignored", friction__law="coulomb", friction__coefficient=0.05
)
SMOOTH = JUMPS.with_(mesh__stiffness={"model": "parabolic", "ramp_length": 3.0})


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
        "multibody.study.causes.prepare", lambda pair, fidelity, initial, effects, rtol, supports: effects
    )
    monkeypatch.setattr("multibody.study.causes.find_orbit", lambda effects, *, near: effects)
    monkeypatch.setattr("multibody.study.causes.cycles_of", motion)
    monkeypatch.setattr("multibody.study.causes.needs_pull", lambda pair, motion: False)
    causes_of = {form: set(default_effects(form)) for form in ("prescribed", "loaded")}
    for form, every in causes_of.items():
        shares = multibody.attribution(JUMPS.with_(mesh__contact=form)).sel(quantity="x_p")
        total = sum(MADE_UP[name] for name in every)
        assert list(shares["cause"].values[-2:]) == ["all", "friction_load"]  # which is no part of it
        assert set(CAUSES) - set(shares["cause"].values) == ({"path_work"} if form == "prescribed" else set())
        for cause in shares["cause"].values:
            group = {name for name in EFFECTS if EFFECTS[name].cause == cause}
            change = total if cause == "all" else sum(MADE_UP[n] for n in group & (every | {"friction_load"}))
            without = total - change if cause in ("all", "sliding_velocity", "path_work") else np.nan
            expected = np.abs([change, without]) / 10.0
            share = shares.sel(cause=cause)
            np.testing.assert_allclose([share["alone"], share["without"]], expected, err_msg=cause)
        assert shares.attrs["largest"] == "contact" if form == "loaded" else "sliding_velocity"


OWN = tomllib.loads(new_pair_text("own", {
    "teeth": "19/41", "basic_rack.module": 2.5, "gears.face_width": 20.0,
    "operating.pinion_speed": 1450.0, "operating.pinion_torque": 80.0,
}))  # fmt: skip


@pytest.mark.parametrize(
    ("source", "contact"), [("nasa_28_28", "loaded"), (OWN, "loaded"), (OWN, "prescribed")]
)
def test_no_teeth_pull_over_a_gap_and_the_largest_change_is_named(source, contact, monkeypatch):
    """Without contact loss the exact contact of the 28/28 pair would pull with 364 N.

    On the own pair the gap closes elsewhere where the place of the contact is nominal, and the change by the
    contact would be five times the whole difference: nothing of the machine, so neither is run.
    """
    runs = []

    def cycles_of(orbit, samples):
        runs.append(causes_cycles_of(orbit, samples))
        return runs[-1]

    causes_cycles_of = causes.cycles_of
    monkeypatch.setattr(causes, "cycles_of", cycles_of)
    result = multibody.attribution(lumped.load_gear_pair(source).with_(mesh__contact=contact))
    contact_of_all = {n for n in default_effects(contact) if EFFECTS[n].cause == "contact"}
    for run in runs[1:]:  # the first is the lumped motion
        names = set(run.attrs["effects"].split(", "))
        assert contact_of_all <= names or not contact_of_all & names
        assert "contact_loss" not in names or float(run["normal_load"].min()) >= 0.0
    alone = result["alone"].sel(quantity="dte").drop_sel(cause=["all", "friction_load"])
    assert result.attrs["largest"] == str(alone["cause"][int(alone.to_numpy().argmax())].item())
    assert float(alone.max()) < 1.5 * float(result["alone"].sel(quantity="dte", cause="all"))


def test_a_lumped_motion_that_needs_pulling_teeth_has_no_causes():
    pair = lumped.load_gear_pair("nasa_28_28").with_(mesh__contact="prescribed")  # -181 N
    with pytest.raises(lumped.NumericalError, match="teeth that pull"):
        multibody.attribution(pair)


def test_every_cause_has_an_effect():
    assert {effect.cause for effect in EFFECTS.values()} == set(CAUSES)


def test_flags_name_the_effects():
    default = default_effects("prescribed")
    for name in EFFECTS:
        assert active_effects(effect_flags({name})) == (name,)
        assert active_effects(effect_flags({name: False})) == tuple(n for n in default if n != name)
    further = {name: True for name in EFFECTS if name not in default}
    assert active_effects(effect_flags(further)) == tuple(EFFECTS)
    assert set(active_effects(effect_flags(None, "loaded"))) == set(EFFECTS) - {"friction_load"}
    assert active_effects(effect_flags(None)) == default
    assert effect_flags(()) == 0

"""Do the effect switches say why the models differ?"""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

import lumped
from multibody.contact.effects import EFFECTS, active_effects, effect_flags
from multibody.study.causes import CAUSES, attribution

JUMPS = lumped.load_gear_pair("nasa_28_28").with_(friction__law="coulomb", friction__coefficient=0.05)
SMOOTH = JUMPS.with_(mesh__stiffness={"model": "parabolic", "ramp_length": 3.0})


@pytest.mark.slow
def test_causes_of_the_difference():
    """With smooth stiffness the actual sliding velocity is the cause; jumps add the shift of tooth entry.

    Without friction there is no sliding to matter, and every cause that is left is far smaller.
    """
    smooth = attribution(SMOOTH, 5)
    assert smooth.attrs["largest"] == "sliding_velocity"
    dte = smooth["alone"].sel(quantity="dte")
    assert float(dte.sel(cause="sliding_velocity")) == pytest.approx(float(dte.sel(cause="all")), rel=0.1)
    assert float(dte.sel(cause="entry_shift")) < 1e-5
    jumps = attribution(JUMPS, 5)["alone"].sel(quantity="dte")
    assert float(jumps.sel(cause="entry_shift")) > 100 * float(dte.sel(cause="entry_shift"))
    still = attribution(SMOOTH.with_(friction__law="none"), 5)["alone"]
    assert float(still.sel(cause="all", quantity="dte")) < 0.05 * float(dte.sel(cause="all"))
    assert np.isnan(still.sel(cause="all", quantity="y_p"))


@pytest.mark.slow
def test_bearings_multiply_the_shift_of_entry():
    """Teeth enter late by half the wind-up q = delta + x_g - x_p; only both causes together see all of it.

    The entering gear tip meets the pinion where rho_g = L + delta - rho_p. With the contact's mean place
    held that is (L - L_XY + delta)/2 after A, and the line of action has grown by L - L_XY = x_g - x_p. With
    the nominal line (entry shift alone) only delta/2 is left; without entry shift, next to nothing.
    """
    pair = lumped.load_gear_pair("fzg_c").with_(
        mesh__stiffness={"model": "parabolic"}, operating__pinion_speed=0.3 * 2170
    )
    found = attribution(pair, periodic=True)["alone"].sel(quantity="dte")
    motion = lumped.steady_state(pair)
    delta = float(motion["dte"].mean())
    spread = float((motion["x_g"] - motion["x_p"]).mean())
    # The difference is the rate of the transmission error just after entry, held for the delay.
    speed = pair.operating.pinion_speed * lumped.geometry(pair).base_radius_pinion
    rate = float(np.abs(motion["dte_dot"]).max() / np.ptp(motion["dte"].to_numpy()))
    for cause, shift in (("entry_shift", 0.5 * delta), ("all", 0.5 * (delta + spread))):
        # First order in the delay, which is a twentieth of the period of the ringing after entry.
        assert float(found.sel(cause=cause)) == pytest.approx(rate * shift / speed, rel=0.25), cause
    assert float(found.sel(cause="contact_position")) < 0.05


#: What each effect adds to every quantity of a made-up motion of span 10: all sums differ.
MADE_UP = {
    "rotation_phase": 1.0,
    "moving_line": 2.0,
    "sliding_velocity": -4.0,
    "entry_shift": 0.5,
    "contact_loss": 0.25,
}


@pytest.mark.parametrize("periodic", [False, True])
def test_changes_alone_and_without_are_told_apart(monkeypatch, periodic):
    """Effects that simply add: alone is the own part, without is the rest, each over the motion's span."""
    asked = []

    def motion(kind):
        def run(pair, *args, effects, **options):
            asked.append((kind, frozenset(effects)))
            # The largest change is at one time only, with either sign.
            values = np.array([0.0, 10.0, 5.0 + sum(MADE_UP[name] for name in effects)])
            return xr.Dataset(dict.fromkeys(("dte", "x_p", "y_p", "theta_p"), ("time", values)))

        return run

    monkeypatch.setattr("multibody.study.causes.simulate", motion("run"))
    monkeypatch.setattr("multibody.study.causes.steady_state", motion("periodic"))
    found = attribution(JUMPS, periodic=periodic).sel(quantity="x_p")
    assert {kind for kind, _ in asked} == {"periodic" if periodic else "run"}
    total = sum(MADE_UP.values())
    for cause, names in CAUSES.items():
        own = sum(MADE_UP[name] for name in names)
        assert float(found["alone"].sel(cause=cause)) == pytest.approx(abs(own) / 10.0), cause
        assert float(found["without"].sel(cause=cause)) == pytest.approx(abs(total - own) / 10.0), cause
    assert float(found["alone"].sel(cause="all")) == pytest.approx(abs(total) / 10.0)
    assert float(found["without"].sel(cause="all")) == 0.0
    assert found.attrs["largest"] == "sliding_velocity"


def test_every_effect_belongs_to_one_cause():
    assert sorted(name for names in CAUSES.values() for name in names) == sorted(EFFECTS)


def test_flags_name_the_effects():
    for name in EFFECTS:
        assert active_effects(effect_flags({name})) == (name,)
        assert active_effects(effect_flags({name: False})) == tuple(n for n in EFFECTS if n != name)
    assert active_effects(effect_flags(None)) == tuple(EFFECTS)
    assert effect_flags(()) == 0

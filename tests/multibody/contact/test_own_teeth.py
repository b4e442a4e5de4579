"""Gears whose teeth differ: the first law, faults against the lumped model's, refusals."""

import numpy as np
import pytest

import lumped
import multibody
from lumped.model.tooth_laws import ToothLaws
from multibody.contact import kinematics as kn
from multibody.contact.kinematics import tooth_pair
from multibody.contact.machine import machine

ERRORS = [round(1.5 * np.sin(2.1 * j) + 0.9 * np.cos(5.3 * j), 3) for j in range(28)]
OWN = {
    "pinion.deviations": {"index": ERRORS, "profile_slope": ERRORS[::-1], "first_order": "steps"},
    "gear.deviations": {"index": ERRORS[::-1], "profile_slope": ERRORS, "first_order": "steps"},
    "pinion.mounting": {"eccentricity": 4, "phase": 70},
    "gear.mounting": {"eccentricity": 6},
}


@pytest.fixture(scope="module")
def pair():
    changes = {"mesh.contact": "loaded", "mesh.relief": "ignored", "operating.pinion_torque": 14.0}
    changes |= {"operating.pinion_speed": 1450, "friction.law": "coulomb", "friction.coefficient": 0.0}
    return lumped.load_gear_pair("nasa_28_28").with_(changes)


CRACK = {"kind": "crack", "tooth": 3, "depth": 1.5}


def test_first_law_holds_with_own_gaps_eccentric_base_circles_cracks_and_ripples(pair):
    changes = {"gear.mounting": {"eccentricity": 40}, "friction.coefficient": 0.05}
    changes |= {f"{gear}.faults": [CRACK] for gear in ("pinion", "gear")}
    changes["pinion.deviations"] = OWN["pinion.deviations"] | {"tip_relief": [3.0] * 14 + [0.0] * 14}
    ripples = [{"shaft": gear, "order": 5, "amplitude": 2, "phase": 30} for gear in ("pinion", "gear")]
    pair = pair.with_(OWN | changes | {"operating.torque_ripple": ripples})
    balance = multibody.power_balance(pair, cycles=4, initial="periodic")
    assert abs(balance.residual) < 1e-8 * balance.driving
    # A ripple at the actual angle of its shaft does the work A/n sin(n theta + phase).
    run = multibody.simulate(pair, 4, initial="periodic")
    given, rates = run.attrs, (pair.geometry.omega_pinion, pair.geometry.omega_gear)
    for name, torque, rate, work in (
        ("theta_p", given["pinion_torque"], rates[0], balance.driving),
        ("theta_g", given["brake_torque"], rates[1], balance.braking),
    ):
        turned = (rate * run.time + run[name])[[0, -1]].values
        ripple = np.diff(0.4 * np.sin(5.0 * turned + np.radians(30.0)))[0]
        assert work == pytest.approx(torque * np.diff(turned)[0] + ripple, rel=1e-9), name


@pytest.mark.parametrize("which", [0, 1])
def test_faults_are_those_of_the_lumped_model_by_the_actual_lengths(pair, which):
    # The lumped model has the arm from the point of contact on the tooth, this one from the line of action.
    pair = pair.with_({"mesh.backlash": 0, "mesh.first_teeth": [1, 5]})
    g, flank = pair.geometry, pair.flank(which)
    low, high, end = np.degrees(flank.start + np.array([2e-3, 4e-3, 6e-3])) / flank.wheel.tooth.base_radius
    tooth = (3, 7)[which]
    spall = {"kind": "spall", "tooth": tooth, "start_roll_angle": low, "end_roll_angle": high, "width": 3}
    pit = {**spall, "width": None, "pit_depth": 7}
    crack, chip = {**CRACK, "tooth": tooth}, {"kind": "chip", "tooth": tooth, "roll_angle": end}
    xi = np.linspace(g.L_XA, g.L_XD, 12)[1:-1]
    for fault in (crack, spall, pit, chip):
        own = pair.with_({("pinion.faults", "gear.faults")[which]: [fault]})
        laws, p = ToothLaws(own), machine(own).parameters
        whole, faulty = (laws.of_kind(kind, xi) for kind in (0, 1))
        (k0, k), (gap0, gap) = ([one[name] for one in (whole, faulty)] for name in ("stiffness", "gap"))

        def found(x, p=p, at=2 * g.base_pitch):  # two pairs later these teeth are in contact
            return tooth_pair(p[int(p[kn.OWN]) :], p, x + at, g.L_XY - x - at, np.array([x, g.L_XY - x]), x)

        pairs = [found(x) for x in xi]
        scale = max((1.0 / k - 1.0 / k0).max(), 1e-12)
        assert [o.softer for o in pairs] == pytest.approx(1.0 / k - 1.0 / k0, abs=1e-9 * scale)
        assert [o.error for o in pairs] == pytest.approx(gap - gap0, abs=1e-15)
        assert (g.L_XY - pairs[0].tip_g, pairs[0].tip_p) == pytest.approx(laws.ends(1)[:2], rel=1e-12)
        if fault is crack:
            slopes = [(found(x + 1e-8).softer - found(x - 1e-8).softer) / 2e-8 for x in xi]
            assert [o.slope for o in pairs] == pytest.approx(slopes, rel=1e-5)


def test_what_it_does_not_have_is_refused(pair):
    with pytest.raises(lumped.ParameterError, match="fidelity"):
        multibody.simulate(pair.with_(OWN), 1, fidelity="linear")

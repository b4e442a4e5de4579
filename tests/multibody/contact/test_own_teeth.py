"""Gears whose teeth differ: the first law, faults against the lumped model's, refusals."""

import numpy as np
import pytest
from scipy.optimize import brentq

import lumped
import multibody
from lumped.model.periodic_system import LTVSystem
from lumped.model.tooth_laws import ToothLaws
from multibody.contact.kernels import tooth_forces
from multibody.contact.machine import machine
from multibody.contact.records import (
    BLOCKS,
    CONTACTS_SIZE,
    COORDINATES,
    PHI_P,
    opened,
    opened_contacts,
    opened_records,
    opened_table,
    with_block,
)
from multibody.contact.tooth_pairs import OwnTeeth, TurnedArcs, teeth_of_pair, tooth_pair
from multibody.run.effects import effect_flags
from tests.unlike_pairs import unlike_pair

CRACK = {"kind": "crack", "tooth": 3, "depth": 1.5}


@pytest.fixture(scope="module")
def pair():
    return unlike_pair("rack_25_degrees_always_pushing")


def test_first_law_holds_with_own_gaps_eccentric_base_circles_cracks_and_ripples():
    """Every kind of difference between teeth at once, on the pair that has classes of deviations already."""
    changes = {"pinion.mounting": {"eccentricity": 4, "phase": 70}, "gear.mounting": {"eccentricity": 40}}
    changes |= {f"{gear}.faults": [CRACK] for gear in ("pinion", "gear")}
    slopes = [round(1.5 * np.sin(2.1 * j) + 0.9 * np.cos(5.3 * j), 3) for j in range(20)]
    changes["pinion.deviations"] = {
        "index": slopes[::-1], "profile_slope": slopes, "tip_relief": [3.0] * 10 + [0.0] * 10,
        "first_order": "steps",
    }  # fmt: skip
    changes["gear.deviations"] = {"tolerance_class": 7, "seed": 5, "first_order": "steps"}
    ripples = [{"shaft": gear, "order": 5, "amplitude": 2, "phase": 30} for gear in ("pinion", "gear")]
    pair = unlike_pair("unlike_teeth_finite_elements").with_(changes | {"operating.torque_ripple": ripples})
    run = multibody.simulate(pair, 4, initial="periodic")
    start = [
        float(run[name][0]) for name in LTVSystem.of(pair.healthy, "full", supports="springs").state_names
    ]
    balance = multibody.power_balance(pair, cycles=4, initial=start)
    assert abs(balance.residual) < 1e-8 * balance.driving
    # A ripple at the actual angle of its shaft does the work A/n sin(n theta + phase).
    attributes = run.attrs
    rates = (pair.geometry.omega_pinion, pair.geometry.omega_gear)
    for name, torque, rate, work in (
        ("theta_p", attributes["pinion_torque"], rates[0], balance.driving),
        ("theta_g", attributes["brake_torque"], rates[1], balance.braking),
    ):
        angles = (rate * run.time + run[name])[[0, -1]].values
        ripple = np.diff(0.4 * np.sin(5.0 * angles + np.radians(30.0)))[0]
        # Both are runs at a relative tolerance of 1e-8.
        assert work == pytest.approx(torque * np.diff(angles)[0] + ripple, rel=1e-8), name


@pytest.mark.parametrize("gear_index", [0, 1])
def test_faults_are_those_of_the_lumped_model_by_the_actual_lengths(pair, gear_index):
    # The lumped model has the arm from the point of contact on the tooth, this one from the line of action.
    pair = pair.with_({"mesh.backlash": 0, "mesh.first_teeth": [1, 5]})
    g = pair.geometry
    flank = pair.flank(gear_index)
    low, high, end = np.degrees(flank.start + np.array([2e-3, 4e-3, 6e-3])) / flank.wheel.tooth.base_radius
    tooth = (3, 7)[gear_index]
    spall = {"kind": "spall", "tooth": tooth, "start_roll_angle": low, "end_roll_angle": high, "width": 3}
    pit = {**spall, "width": None, "pit_depth": 7}
    crack = {**CRACK, "tooth": tooth}
    chip = {"kind": "chip", "tooth": tooth, "roll_angle": end}
    xi = np.linspace(g.L_XA, g.L_XD, 12)[1:-1]
    for fault in (crack, spall, pit, chip):
        damaged = pair.with_({("pinion.faults", "gear.faults")[gear_index]: [fault]})
        laws = ToothLaws(damaged)
        sound, faulty = (laws.of_kind(kind, xi) for kind in (0, 1))
        softer = 1.0 / faulty["stiffness"] - 1.0 / sound["stiffness"]
        numbers = machine(damaged)
        record = numbers.record
        teeth = OwnTeeth(*(opened_records(numbers.packed, name) for name in ("teeth_p", "teeth_g", "faults")))

        def fault_at(x, record=record, teeth=teeth, offset=2 * g.base_pitch):
            """The teeth in contact at x; two pairs later than pair 0."""
            arcs = TurnedArcs(x + offset, g.L_XY - x - offset)
            return tooth_pair(record, teeth, teeth_of_pair(record, teeth, arcs, x, g.L_XY - x), x)

        pairs = [fault_at(x) for x in xi]
        scale = max(softer.max(), 1e-12)
        assert [o.compliance for o in pairs] == pytest.approx(softer, abs=1e-9 * scale)
        assert [o.error for o in pairs] == pytest.approx(faulty["gap"] - sound["gap"], abs=1e-15)
        assert (g.L_XY - pairs[0].tip_g, pairs[0].tip_p) == pytest.approx(laws.ends(1)[:2], rel=1e-12)
        if fault is crack:
            slopes = [(fault_at(x + 1e-8).compliance - fault_at(x - 1e-8).compliance) / 2e-8 for x in xi]
            assert [o.compliance_slope for o in pairs] == pytest.approx(slopes, rel=1e-5)


def test_what_it_does_not_have_is_refused():
    with pytest.raises(lumped.ParameterError, match="fidelity"):
        multibody.simulate(unlike_pair("unlike_teeth_finite_elements"), 1, fidelity="linear")


#: A displacement of 1 um along the reference circle of a 25-degree rack: so much along the line of action.
MOVED = 1e-6 * np.cos(np.radians(25.0))
#: The tooth that is displaced, counted from 1.
DISPLACED_TOOTH = 3


@pytest.mark.parametrize(("gear", "lag"), [("pinion", MOVED), ("gear", -MOVED)])
def test_a_displaced_tooth_that_carries_alone_makes_the_gear_lag_or_lead(gear, lag):
    """Teeth are counted as they come into mesh, so the count runs against the rotation, on both gears.

    The pinion pushes with the front of its teeth. One that lies further along the count stands back: the
    pinion turns on by the displacement before it pushes, and the gear lags. The gear is pushed at the back of
    its teeth. One that lies further along the count stands closer to the pinion, and the gear leads.
    """
    pair = unlike_pair("rack_25_degrees_always_pushing")
    flags = effect_flags(None, "loaded")

    def approach(displacement, cycle):
        """How far the pinion is turned against its running sense, at rest, until the teeth carry 5 kN [m]."""
        index = [0.0] * getattr(pair, gear).teeth
        index[DISPLACED_TOOTH - 1] = displacement
        displaced = pair.with_({f"{gear}.deviations": {"index": index, "first_order": "steps"}})
        numbers = machine(displaced, flags)
        contacts = np.zeros(CONTACTS_SIZE)
        radius = numbers.record.geometry.radius_p

        def load(delta):
            state = np.zeros((3, 6))
            state[COORDINATES, PHI_P] = -delta / radius
            # Tooth 3 comes to A after two mesh cycles; from 0.7 to 0.95 of a cycle one pair carries alone.
            t = (cycle + 0.8) * numbers.period
            count = tooth_forces(t, state, numbers.packed, flags, contacts)
            assert np.count_nonzero(opened_contacts(contacts)["load"][:count]) <= 1
            return opened_contacts(contacts)["load"][:count].sum() - 5e3

        return brentq(load, 1e-5, 4e-5, xtol=1e-16)

    assert approach(1.0, 2) - approach(0.0, 2) == pytest.approx(lag, rel=1e-6)
    assert approach(1.0, 1) == approach(0.0, 1)
    assert approach(1.0, 3) == approach(0.0, 3)


def test_another_table_in_a_machine_leaves_its_numbers_and_all_other_blocks(pair):
    """Behind a longer table the blocks begin elsewhere, and hold what they held."""
    packed = machine(pair.with_({"pinion.faults": [CRACK]})).packed
    places = opened(packed).blocks
    table = np.arange(30.0).reshape(6, 5)
    changed = with_block(packed, "stiffness", table)
    now = opened(changed).blocks
    filled = 0
    for name in BLOCKS.names:
        expected = table if name == "stiffness" else opened_table(packed, places[name])
        np.testing.assert_array_equal(opened_table(changed, now[name]), expected)
        filled += expected.size > 0
    assert filled > 3  # stiffness, friction or friction laws, teeth of both gears, faults
    assert opened(changed).geometry == opened(packed).geometry
    assert opened(changed).pair_law == opened(packed).pair_law

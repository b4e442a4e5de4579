"""Does the prediction from the lumped model alone say what finite motions change in the multibody model?"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import lumped
import multibody
from lumped import ParameterError
from lumped.model.mesh_cycle import mesh_cycle
from lumped.model.periodic_system import periodic_system
from lumped.path_function import PathFunction
from validation.cross_check.agreement import contact_shift, off_switch_samples
from validation.cross_check.finite_motion import PREDICTED as EVERY
from validation.cross_check.finite_motion import finite_motion
from validation.cross_check.shifted_motion import ShiftedModel

PREDICTED = EVERY["prescribed"]
RECTANGULAR = lumped.load_gear_pair("nasa_28_28").with_(
    mesh__relief="ignored", friction__law="xu_kahraman", mesh__stiffness={"model": "rectangular"}
)
#: Unequal gears, slow: rotation moves the contact, late entry rings the mesh for long.
UNEQUAL = lumped.load_gear_pair("fzg_c").with_(
    friction__law="xu_kahraman", mesh__stiffness={"model": "parabolic"}, operating__pinion_speed=651
)
#: The same where stiffness changes along the path and does not jump: only the place of the contact matters.
SMOOTH = UNEQUAL.with_(mesh__stiffness={"model": "parabolic", "ramp_length": 2.0})


def unexplained(pair, effects=PREDICTED, quantities=("dte", "x_p", "y_p", "normal_load", "friction_force")):
    """Per quantity: the change in the multibody model over the lumped motion, and the share not predicted."""
    cycle = lumped.steady_state(pair, samples_per_cycle=128)
    predicted = finite_motion(pair, cycle, effects)
    assert predicted.settled
    run = multibody.steady_state(pair, samples_per_cycle=128, effects=set(effects), rtol=1e-10)
    keep = off_switch_samples(pair, cycle["time"].to_numpy())
    found = {}
    for name in quantities:
        change = (run[name].to_numpy() - cycle[name].to_numpy())[..., keep]
        left = change - predicted.changes[name][..., keep]
        size = np.linalg.norm(change)
        motion = np.linalg.norm(cycle[name].to_numpy()[..., keep])
        found[name] = float(size / motion), float(np.linalg.norm(left) / size)
    return found


@pytest.mark.parametrize("pair", [RECTANGULAR, UNEQUAL], ids=["equal", "unequal"])
def test_late_entry_and_early_exit_alone(pair):
    """One effect, the same equations: only integration and the reading of the motion between times err.

    The events are known to a share of a time step, 1/4096 of a pitch, squared; they move by some 1e-3 of it.
    """
    for name, (size, share) in unexplained(pair, {"entry_shift"}).items():
        assert size > 5e-4, name
        assert share < 2e-4, name


def test_actual_sliding_velocity_alone():
    for name, (size, share) in unexplained(RECTANGULAR, {"sliding_velocity"}).items():
        assert size > 5e-4, name
        assert share < 1e-3, name


@pytest.mark.parametrize(
    ("pair", "effects"),
    [
        (RECTANGULAR, {"entry_shift", "rotation_phase", "moving_line"}),
        (RECTANGULAR, set(PREDICTED)),
        (UNEQUAL, set(PREDICTED)),
        (SMOOTH, set(PREDICTED)),
    ],
    ids=["contact", "all", "all, unequal", "all, smooth"],
)
def test_effects_together(pair, effects):
    """What is left is not predicted: displacements over lengths of the machine, some 1e-3 of the change."""
    for name, (size, share) in unexplained(
        pair, effects, ("dte", "y_p", "normal_load", "friction_force")
    ).items():
        assert size > 1e-3, name
        assert share < 2e-2, name


def test_bearings_make_most_of_the_delay_on_the_slow_unequal_pair():
    """Entry shifts by half the wind-up delta + x_g - x_p, not by delta/2: here five times more."""
    cycle = lumped.steady_state(UNEQUAL, samples_per_cycle=128)
    alone, both = (
        finite_motion(UNEQUAL, cycle, effects)
        for effects in ({"entry_shift"}, {"entry_shift", "rotation_phase", "moving_line"})
    )
    delta = float(cycle["dte"].mean())
    wind_up = delta + float((cycle["x_g"] - cycle["x_p"]).mean())
    # The motion at entry departs from its mean by its swing: a quarter of delta, a twentieth of the wind-up.
    assert alone.entry == pytest.approx(0.5 * delta, rel=0.3)
    assert both.entry + both.exit == pytest.approx(wind_up, rel=0.06)
    assert both.entry > 3.0 * alone.entry


def test_what_is_left_vanishes_faster_than_the_motion():
    """The change over the motion falls with torque; so does what is left, and it stays below the shift."""
    for torque in (56.5, 56.5 / 8):
        pair = RECTANGULAR.with_(
            friction__law="coulomb", friction__coefficient=0.05, operating__pinion_torque=torque
        )
        shift = contact_shift(pair, lumped.steady_state(pair, samples_per_cycle=128))
        for name, (size, share) in unexplained(pair).items():
            assert size * share < 0.2 * shift, (name, torque)


def test_the_turned_line_moves_the_vibration_and_with_it_the_reversal():
    """The spring N/L between y_p and y_g changes the frequencies of the 50/50 pair's bearings by 4e-5 only.

    Added to y afterwards, without what that y does to friction, it leaves 1.7 times the shift.
    """
    pair = lumped.load_gear_pair("kahraman_blankenship_50_50").with_(
        friction__law="composite", mesh__stiffness={"model": "rectangular"}, operating__pinion_speed=450
    )
    shift = contact_shift(pair, lumped.steady_state(pair, samples_per_cycle=128))
    size, share = unexplained(pair, quantities=("y_p",))["y_p"]
    assert size > 1.0
    assert size * share < 0.6 * shift


def test_friction_holds_where_it_can_take_all_of_the_sliding_acceleration():
    """Filippov's condition in the nominal motion, where the sliding acceleration at P is known.

    Sliding passes P with (Omega_p + Omega_g) Omega_p r_bp plus what vibration adds; friction takes
    mu N (1/m_p + 1/m_g + X_p^2/J_p + X_g^2/J_g) of it on either side.
    """
    pair = RECTANGULAR.with_(friction__law="coulomb", friction__coefficient=0.05)
    cycle = mesh_cycle(pair)
    g, system = cycle.geometry, periodic_system(pair, "full", cycle=cycle)
    times = np.arange(4096) * (cycle.period / 4096)
    model = ShiftedModel(pair, cycle, system, np.zeros(12), times, frozenset({"sliding_velocity"}), 0.0)
    shifts = model.shifts_after(model.motion(None))
    motion = model.motion(shifts)
    way = model.shifts_after(motion).slides_as
    at = int(np.searchsorted(way, g.L_XP))
    m = system.structure.mass
    mobility = 1 / m[4] + 1 / m[5] + g.L_XP**2 / m[0] + (g.L_XY - g.L_XP) ** 2 / m[1]
    taken = 0.05 * motion.load[at] * mobility
    slope = (way[at - 1] - way[at - 2]) / (motion.place[at - 1] - motion.place[at - 2])
    before = slope * (g.omega_pinion + g.omega_gear) * g.omega_pinion * g.base_radius_pinion
    assert (
        0.02 * before < taken < before
    )  # approach: friction hurries the sliding on, by as much as it then takes
    free = before - taken
    # The same motion with more friction at zero sliding alone, as if the law rose there.
    for share, held in ((0.99, False), (1.01, True)):
        friction = PathFunction.constant(0.05 * share * free / taken, g.L_XA, g.L_XD)
        laws = replace(cycle.elements, friction=friction)
        steep = replace(model, cycle=replace(cycle, elements=laws))
        assert steep.held(motion) == held


def test_without_friction_nothing_moves_off_the_line_of_action():
    pair = lumped.load_gear_pair("nasa_28_28").with_(mesh__relief="ignored", friction__law="none")
    found = finite_motion(pair, lumped.steady_state(pair, samples_per_cycle=64))
    assert not found.changes["y_p"].any()
    assert not found.changes["friction_force"].any()
    assert np.ptp(found.changes["dte"]) > 0.0


def test_changes_repeat_over_the_cycles():
    cycle = lumped.steady_state(RECTANGULAR, samples_per_cycle=32)
    found = finite_motion(RECTANGULAR, cycle)
    repeated = found.over("normal_load", 70)
    assert repeated.shape == (2, 70)
    np.testing.assert_array_equal(repeated[:, 64:], found.changes["normal_load"][:, :6])
    np.testing.assert_array_equal(found.over("dte", 70)[32:64], found.changes["dte"])


def longest_stay(pair):
    """Longest time of a pair below a thousandth of the sliding range, over the nominal time for that."""
    g, samples = lumped.geometry(pair), 4096
    run = multibody.steady_state(pair, samples_per_cycle=samples)
    per_way = g.omega_pinion + g.omega_gear
    low = 1e-3 * per_way * (g.L_XD - g.L_XA)
    near = (run["contact"].to_numpy() > 0) & (np.abs(run["sliding_velocity"].to_numpy()) < low)
    steps = np.diff(np.pad(near, ((0, 0), (1, 1))).astype(int), axis=1)
    longest = max(int((np.flatnonzero(s < 0) - np.flatnonzero(s > 0)).max(initial=0)) for s in steps)
    nominal = 2.0 * low / (per_way * g.omega_pinion * g.base_radius_pinion)
    return longest * g.mesh_period / samples / nominal


@pytest.mark.slow
@pytest.mark.parametrize(
    ("speed", "coefficient", "settles"),
    [(651, 0.007, True), (2170, 0.2, False)],
)
def test_friction_and_motion_settle_unless_friction_holds_the_teeth(speed, coefficient, settles):
    """The criterion looks at the lumped model alone; the exact motion shows that it is about holding.

    Teeth that pass zero sliding are slowed by friction on one side and hurried on the other. With Filippov's
    ratio r < 1 of friction to what drives the sliding they stay (1/(1 - r) + 1/(1 + r))/2 times the nominal
    time, less than four times for r < 0.86. Teeth that are held stay until something else moves them.
    """
    pair = lumped.load_gear_pair("fzg_c").with_(
        friction__law="coulomb",
        friction__coefficient=coefficient,
        mesh__stiffness={"model": "rectangular"},
        operating__pinion_speed=speed,
    )
    assert finite_motion(pair, lumped.steady_state(pair, samples_per_cycle=128)).settled == settles
    stay = longest_stay(pair)
    assert stay < 4.0 if settles else stay > 4.0


def test_an_effect_that_is_not_predicted_is_refused():
    pair = RECTANGULAR
    with pytest.raises(ParameterError, match="contact_loss"):
        finite_motion(pair, lumped.steady_state(pair, samples_per_cycle=16), {"contact_loss"})


def test_where_the_shifts_do_not_settle_nothing_is_predicted():
    """On so soft bearings the contact would move farther than the path is long: no such motion exists."""
    soft = {f"bearings.{gear}.loa_stiffness": 1e5 for gear in ("pinion", "gear")}
    pair = lumped.load_gear_pair("fzg_c").with_(soft | {"operating.pinion_speed": 300})
    cycle = lumped.steady_state(pair, samples_per_cycle=32)
    predicted = finite_motion(pair, cycle)
    assert not predicted.settled
    assert predicted.changes.keys() == {"dte", "x_p", "x_g", "y_p", "y_g", "normal_load", "friction_force"}
    for name, change in predicted.changes.items():
        assert change.shape == cycle[name].shape
        assert not change.any()

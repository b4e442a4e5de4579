"""Is the motion of teeth that differ right: shifts, sums, like teeth, first law, eccentric gears, statics?"""

import functools

import numpy as np
import pytest

import lumped
from lumped.gauss_legendre import gauss_tableau
from lumped.mesh.damper import FULL_DAMPING
from lumped.mesh.linear import STATE, LinearForm
from lumped.mesh.places import fill_linear_form, kinks, linear_form_at, static_loads
from lumped.mesh.records import FORCE, LINE
from lumped.mesh.tables import TURNING
from lumped.model.cycle_maps import linear_motion
from lumped.model.equations import Y_P
from lumped.model.tooth_laws import ToothLaws, mesh_tables
from lumped.model.unilateral_motion import settled_motion
from lumped.schema.bodies import bodies_of
from tests.lumped.mesh.element_calls import line_at
from tests.unlike_pairs import UNLIKE, unlike_pair

COS = np.cos(np.radians(20.0))
ERRORS = np.random.default_rng(5).normal(size=28) * 5.0
ERRORS -= ERRORS.mean()
SAMPLES = 16
MOTION = {"unilateral": settled_motion, "linear": linear_motion}


@pytest.fixture(scope="module")
def loaded(nasa):
    changes = {"friction.law": "coulomb", "friction.coefficient": 0.06, "operating.pinion_speed": 1500}
    return nasa.with_({**changes, "mesh.contact": "loaded"})


def steps(values):
    return {"index": list(values), "first_order": "steps"}


@pytest.fixture(scope="module")
def dte(loaded):
    """Function: DTE over the period of lists on pinion and gear [um], in a form of contact."""

    @functools.cache
    def transmission_error(form, pinion=None, gear=None, torque=56.5):
        contact, touch = form.split()
        changes = {"mesh.contact": contact, "operating.pinion_torque": torque}
        for name, values in (("pinion", pinion), ("gear", gear)):
            if values is not None:
                changes[f"{name}.deviations"] = steps(values)
        run = MOTION[touch](loaded.with_(changes), SAMPLES, steps=160)
        return run.states[:, :6] @ run.system.structure.deflection * 1e6

    return transmission_error


FORMS = ["prescribed linear", "prescribed unilateral", "loaded unilateral", "loaded linear"]
LIST = tuple(ERRORS)
NONE = (0.0,) * 28


@pytest.mark.parametrize("form", FORMS)
class TestEveryForm:
    def test_equal_lists_on_like_gears_cancel(self, dte, form):
        error = dte(form, LIST, LIST)
        assert error == pytest.approx(dte(form, NONE), abs=1e-10)
        orders = np.abs(np.fft.rfft(error)) / error.size
        orders[::28] = 0.0
        assert orders.max() < 1e-9  # um

    def test_a_list_that_begins_a_tooth_later_is_a_shift_in_time(self, dte, form):
        later = dte(form, tuple(np.roll(ERRORS, 1)))
        assert later == pytest.approx(np.roll(dte(form, LIST), SAMPLES), abs=1e-9)
        assert np.ptp(later) > 1.2 * np.ptp(dte(form, NONE))


class TestFixedContacts:
    """N = k (delta - e) on A to D is linear: sums hold, and a common error moves nothing else."""

    FORM = "prescribed linear"

    def test_a_common_error_is_a_shift_of_delta_and_parts_of_both_gears_add_up(self, dte):
        more = dte(self.FORM, tuple(ERRORS + 3.0))
        mirrored = tuple(ERRORS[::-1])
        assert more - dte(self.FORM, LIST) == pytest.approx(3.0 * COS, abs=1e-9)
        parts = dte(self.FORM, LIST) + dte(self.FORM, None, mirrored) - dte(self.FORM, NONE)
        assert dte(self.FORM, LIST, mirrored) == pytest.approx(parts, abs=1e-9)

    @pytest.mark.parametrize("faults", [[], [{"kind": "crack", "tooth": 1, "depth": 1}]], ids=len)
    def test_maps_of_the_cycles_make_the_motion_of_small_runge_kutta_steps(self, loaded, faults):
        # Errors so small that no pair pulls: both integrate the same equations.
        tips = {f"{g}.{one}": None for g in ("pinion", "gear") for one in ("tip_relief", "tip_diameter")}
        lists = {"pinion": 0.1 * ERRORS[:21], "gear": 0.07 * ERRORS[::-1] + 0.2}
        deviations = {
            f"{g}.deviations": {**steps(e), "profile_slope": list(e[::-1])} for g, e in lists.items()
        }
        changes = {
            "pinion.teeth": 21,
            "centre_distance": None,
            "mesh.contact": "prescribed",
            **tips,
            **deviations,
        }
        changes |= {"mesh.first_teeth": [3, 9], "pinion.faults": faults}
        changes |= {"pinion.mounting": {"eccentricity": 1, "phase": 30}}
        pair = loaded.with_(changes)
        one = linear_motion(pair, SAMPLES, steps=192)
        other = settled_motion(pair, SAMPLES, steps=4096)
        assert other.load[other.load != 0.0].min() > 100.0
        scale = np.abs(other.states[:, 2:6]).max(axis=0)
        assert one.states[:, 2:6] / scale == pytest.approx(other.states[:, 2:6] / scale, abs=1e-8)
        assert one.brake_torque == pytest.approx(other.brake_torque, rel=1e-9)

    def test_errors_of_zero_mean_leave_mesh_harmonics_and_own_gaps_do_not(self, dte):
        def change_of_harmonics(form):
            one, healthy = (np.abs(np.fft.rfft(dte(form, values))[28:85:28]) for values in (LIST, NONE))
            return np.abs(one / healthy - 1.0).max()

        assert change_of_harmonics(self.FORM) < 1e-10
        assert change_of_harmonics("loaded unilateral") > 0.01

    def test_torque_and_errors_times_two_double_the_motion_unless_corners_touch(self, dte):
        def nonlinearity(form):
            single = dte(form, LIST)
            return np.abs(dte(form, tuple(2.0 * ERRORS), None, 113.0) - 2.0 * single).max() / np.ptp(single)

        assert nonlinearity(self.FORM) < 1e-9
        assert nonlinearity("prescribed unilateral") < 1e-9
        assert nonlinearity("loaded unilateral") > 0.1


def test_like_teeth_move_as_the_loaded_form_says(loaded, dte):
    # Steps are not cut where a pair touches first, so the error falls with their length alone.
    twin = lumped.steady_state(loaded, samples_per_cycle=SAMPLES)
    expected = twin.dte.values * 1e6
    assert np.tile(expected, 28) == pytest.approx(dte("loaded linear", NONE), abs=0.02 * np.ptp(expected))
    pair = loaded.with_({"pinion.deviations": steps(NONE)})
    fine = linear_motion(pair, SAMPLES, steps=640)
    transmission_error = fine.states[:SAMPLES, :6] @ fine.system.structure.deflection * 1e6
    assert transmission_error == pytest.approx(expected, abs=2e-3 * np.ptp(expected))
    swing = np.ptp(twin.y_p.values)  # of corners too, which push off the line of action
    assert fine.states[:SAMPLES, Y_P] == pytest.approx(twin.y_p.values, abs=2e-3 * swing)
    assert fine.brake_torque - fine.powers["rolling"] / pair.geometry.omega_gear == pytest.approx(
        lumped.steady_state(loaded).attrs["brake_torque"], rel=1e-6
    )


#: Pairs whose teeth differ: on both gears, first harmonics as eccentricities; with tip relief and a crack; on
#: the gear that is driven by the larger one. Contact is kept, or no motion would have the period.
OWN = {
    "unlike_teeth_finite_elements": {},
    "heavily_relieved_under_load": {
        "pinion.deviations": {"tolerance_class": 6, "seed": 2, "first_order": "steps"},
        "pinion.mounting": {"eccentricity": 11, "phase": 40},
        "pinion.faults": [{"kind": "crack", "tooth": 3, "depth": 2.0}],
    },
    "larger_gear_drives_contact_lost": {
        "gear.deviations": {"tolerance_class": 5, "seed": 7},
        "mesh.damping_ratio": 0.05,
        "operating.pinion_speed": 2500,
    },
}


@pytest.mark.parametrize("name", OWN)
def test_first_law_holds_over_the_period_with_the_moment_of_eccentric_gears(name):
    pair = unlike_pair(name).with_(OWN[name])
    pushed = lumped.steady_state(pair, contact="unilateral", samples_per_cycle=8)
    g = pair.geometry
    attributes = pushed.attrs
    driving = pair.operating.pinion_torque * g.omega_pinion
    braking = attributes["brake_torque"] * g.omega_gear
    lost = attributes["power_sliding"] + attributes["power_tooth_dampers"] + attributes["power_bearings"]
    # Steps of the default length leave 2e-5 of the loss where tips jump in and out under heavy relief.
    assert driving - braking == pytest.approx(lost, rel=1e-4)


def test_linear_form_has_the_losses_of_the_unilateral_motion_where_every_pair_pushes():
    pair = unlike_pair("unlike_teeth_finite_elements")
    pushed = lumped.steady_state(pair, contact="unilateral", samples_per_cycle=8)
    # Both integrate all losses; the moments of the eccentric gears turn both.
    tied = lumped.steady_state(pair, samples_per_cycle=8, contact="linear")
    for name, near in (("brake_torque", 1e-5), ("power_sliding", 1e-3), ("power_bearings", 0.02)):
        assert tied.attrs[name] == pytest.approx(pushed.attrs[name], rel=near), name
    assert np.ptp(tied.theta_p.values) == pytest.approx(np.ptp(pushed.theta_p.values), rel=0.01)


@pytest.mark.parametrize("eccentric", ["pinion", "gear"])
def test_power_without_friction_goes_into_dampers_and_bearings(eccentric):
    """First law at both shafts, 43 teeth on 22: the moment of an eccentric gear works at that gear's speed.

    At the other gear's speed this work would be wrong by 5 % of all losses for the pinion, 33 % for the gear.
    """
    mounted = {f"{eccentric}.mounting": {"eccentricity": 150, "phase": 70}}
    pair = unlike_pair("larger_gear_drives_contact_lost").with_(
        {"friction.law": "none", "operating.pinion_speed": 900, **mounted}
    )
    attributes = lumped.steady_state(pair, samples_per_cycle=8).attrs
    g = pair.geometry
    driving = pair.operating.pinion_torque * g.omega_pinion
    braking = attributes["brake_torque"] * g.omega_gear
    lost = attributes["power_tooth_dampers"] + attributes["power_bearings"]
    # Steps leave 2e-3 of the losses where pairs touch inside them.
    assert driving - braking == pytest.approx(lost, rel=0.01)


@pytest.mark.parametrize("name", OWN)
def test_a_transient_settles_to_the_periodic_motion_and_stays_on_it(name):
    first = {} if "mounting" in str(OWN[name]) else {"mesh.first_teeth": [3, 1]}
    pair = unlike_pair(name).with_(OWN[name] | first)
    period = lumped.revolution(pair)
    cycles = 150
    steady = lumped.steady_state(pair, contact="unilateral", samples_per_cycle=8)
    size = np.ptp(steady.dte.values)
    force = pair.operating.pinion_torque / pair.geometry.base_radius_pinion
    for initial, skipped_cycles in (("periodic", 0), ("static", 100)):
        run = lumped.simulate(pair, cycles, contact="unilateral", samples_per_cycle=8, initial=initial)
        assert (run.sizes["time"], run.attrs["teeth"]) == (cycles * 8 + 1, "as given")
        tooth = (
            "gear_tooth" if period == pair.gear.teeth else "pinion_tooth"
        )  # the other one has no such period
        for variable, close in (("dte", 1e-5 * size), ("normal_load", 1e-6 * force), (tooth, 0.5)):
            expected = np.take(steady[variable].values, np.arange(cycles * 8 + 1) % (period * 8), axis=-1)
            error = np.abs(run[variable].values - expected)[..., skipped_cycles * 8 :]
            assert error.max() < close, (initial, variable)


class TestEccentricGears:
    def test_line_of_action_of_base_circles_off_their_axes(self, unequal):
        # Exact: both base circles and their inner tangent, from the distance of the centres.
        g = unequal.geometry
        radius = g.base_radius_pinion + g.base_radius_gear
        eps = 2e-9
        turn = 0.83

        def line(u):
            """Length of the line of action [m] and its angle [rad]; u along and off it."""
            along = g.L_XY - u[0]
            across = radius - u[1]
            length = np.sqrt(along**2 + across**2 - radius**2)
            return length, np.arctan2(across, along) - np.arctan2(radius, length)

        for gear_index, u in enumerate(
            (eps * np.array([-np.cos(turn), np.sin(turn)]), -eps * np.array([np.cos(turn), np.sin(turn)]))
        ):
            turning = np.zeros(2, TURNING)
            turning["cycles"] = 25, 31
            turning["amplitude"][gear_index] = eps
            turning["start"][gear_index] = turn - 0.5
            tables = mesh_tables(ToothLaws(unequal), 1.0, 1)
            tables.turned[0, 0, gear_index] = np.cos(0.5), np.sin(0.5)
            tables = tables._replace(turning=turning, lengthening=0.0)
            moved_line = np.zeros(1, LINE)
            starts = np.zeros((2, 2))
            starts[gear_index] = eps * np.cos(turn - 0.5), eps * np.sin(turn - 0.5)
            gap, _ = line_at(0, 0, tables, starts, moved_line)
            length, angle = line(u)
            assert moved_line["length"][0] - g.L_XY == pytest.approx(length - g.L_XY, rel=1e-5)
            assert moved_line["turn"][0] == pytest.approx(angle, rel=1e-5)
            assert gap == pytest.approx(length - g.L_XY - radius * angle, rel=1e-5)

    def test_an_eccentric_gear_makes_small_sidebands_where_a_list_of_steps_makes_large_ones(self, loaded):
        staircase = 20.0 / COS * np.cos(2.0 * np.pi * np.arange(28) / 28)
        turning = {"pinion.mounting": {"eccentricity": 20}}
        listed = {"pinion.deviations": steps(staircase)}
        side = {}
        for name, change in (("turning", turning), ("steps", listed)):
            run = settled_motion(loaded.with_(change), SAMPLES, steps=160)
            te = run.states[:, :6] @ run.system.structure.deflection
            orders = 2.0 * np.abs(np.fft.rfft(te)) / te.size
            assert orders[1] == pytest.approx(20e-6, rel=0.02)
            side[name] = orders[[27, 29]].max()
        # The moment of the eccentric gear swings the free train too, which adds to the sidebands.
        assert side["steps"] > 5.0 * side["turning"]


def inside(pair, loads):
    """Gap of each pair at each output, whether it carries away from the tips, and k of a rectangular pair."""
    g = pair.geometry
    teeth = (loads.pinion_tooth.values - 1, loads.gear_tooth.values - 1)
    phase = loads.phase.values if "phase" in loads.coords else loads.time.values / g.mesh_period
    ahead = loads.sizes["pair"] - 2 - np.arange(loads.sizes["pair"])  # the last one is behind A
    position = g.L_XA + ((phase + 1e-12) % 1.0 + ahead[:, None]) * g.base_pitch
    inner = (position > g.L_XA + 1.5e-4) & (position < g.L_XD - 1.5e-4) & (loads.normal_load.values > 0.0)
    k = float(lumped.mesh_stiffness(pair).attrs["mean"]) / g.contact_ratio
    return lumped.tooth_gaps(pair).gap.values[teeth], inner, k


class TestOfEveryPair:
    def test_loads_carry_the_force_with_every_pair_on_its_own_gap(self, loaded):
        pair = loaded.with_(
            {"pinion.deviations": steps(3.0 * ERRORS), "gear.deviations": steps(ERRORS[::-1])}
        )
        sharing = lumped.static_sharing(pair, samples_per_cycle=16)
        force = 56.5 / pair.geometry.base_radius_pinion
        assert sharing.normal_load.sum("pair").values == pytest.approx(force, rel=1e-9)
        # Away from the tips a pair is a rectangle of stiffness: where two press, both give the same approach.
        gap, inner, k = inside(pair, sharing)
        pair_approach = sharing.normal_load.values / k + gap
        approach = np.broadcast_to(sharing.transmission_error.values, pair_approach.shape)
        assert inner.sum() > 300
        assert pair_approach[inner] == pytest.approx(approach[inner], rel=1e-9)
        largest = sharing.largest_load.values
        assert np.isfinite(largest).sum() == 28
        assert np.nanmax(largest) >= sharing.normal_load.values.max()

    def test_dampers_begin_together_with_the_elastic_load(self, loaded):
        pair = loaded.with_({"pinion.deviations": steps(3.0 * ERRORS), "operating.pinion_speed": 4000})
        run = lumped.steady_state(pair, contact="unilateral", samples_per_cycle=64)
        gap, inner, k = inside(pair, run)
        elastic = k * (run.dte.values - gap)
        part = np.clip(elastic / FULL_DAMPING / (56.5 / pair.geometry.base_radius_pinion), 0.0, 1.0)
        c = 2.0 * pair.mesh.damping_ratio * np.sqrt(k * bodies_of(pair).effective_mass)
        damper = c * part**2 * (3.0 - 2.0 * part) * run.dte_dot.values
        assert (inner & (part < 0.9) & (abs(damper) > 0.1)).sum() > 20
        assert (run.normal_load.values - elastic)[inner] == pytest.approx(damper[inner], abs=1e-5)

    def test_a_sloping_profile_is_read_where_the_swing_of_the_free_train_has_moved_the_contact(self, loaded):
        slopes = {"profile_slope": [8.0] * 28, "first_order": "steps"}
        mounted = {"eccentricity": 20, "phase": 50}
        pair = loaded.with_({"pinion.deviations": slopes, "pinion.mounting": mounted})
        swing = 3.0
        tables = mesh_tables(ToothLaws(pair), 1.0 / 32, 1)
        tables.turning["swing"][0] = swing
        approach, loads = static_loads(tables, 0, 28)
        tables.turning["swing"][0] = 0.0
        unmoved, others = static_loads(tables, 0, 28)
        single = (loads["static"] + others["static"] > 0.0).sum(axis=-1) == 1
        turn = 2.0 * np.pi / 28 * (np.arange(28)[:, None] + tables.edges[:-1]) + np.radians(50.0)
        flank = pair.flank(0)
        expected = -8e-6 / (flank.tip - flank.start) * swing * 20e-6 * np.sin(turn)
        assert single.sum() > 150
        assert (approach - unmoved)[single] == pytest.approx(expected[single], abs=1e-12)

    def test_sums_of_a_step_with_kinks_have_the_moments_of_what_is_there(self, loaded):
        laws = ToothLaws(loaded.with_({"pinion.deviations": steps(ERRORS)}))
        tables = mesh_tables(laws, 1.0 / 16, 1, gauss_tableau(4).c)
        x = (np.arange(2000) + 0.5) / 2000
        shape = (28, *tables.position.shape[:2])
        form = LinearForm(np.empty((*shape, 3), FORCE), np.empty(shape, STATE))
        fill_linear_form(tables, 0, form)
        places = np.arange(28)[:, None, None], np.arange(shape[1])[:, None], x
        fine, _ = linear_form_at(tables, 0, *places)
        touches = kinks(tables, 0, 28, np.linspace(0.0, 1.0, 3), 16)
        steps_with = np.histogram(touches, np.add.outer(np.arange(28), tables.edges[:-1]).ravel())[0]
        assert (steps_with > 1).sum() > 30
        to_moments = (np.vander(x, 4) @ np.linalg.inv(np.vander(tables.nodes)) / x.size).T
        # Up to 1.5 % of a sum is left where a tip leaves the line of action inside a step.
        for coarse, exact in zip(form, fine, strict=True):
            for name in coarse.dtype.names:
                interpolated = coarse[name].reshape(*shape, -1)
                wanted = to_moments @ exact[name].reshape(*shape[:2], x.size, -1)
                wrong = np.abs(tables.weights[:, None] * interpolated - wanted).max(axis=(0, 1, 2))
                assert (wrong <= 0.02 * np.abs(wanted).max(axis=(0, 1, 2))).all(), name


@pytest.mark.parametrize("form", FORMS)
def test_ripple_of_the_torque_is_carried_to_the_other_shaft(loaded, form):
    # Far below every resonance the load follows the torque: N = (T + A cos)/r_b of order 5 of the pinion,
    # less what turns both inertias; J_g/(J_p + J_g) = 1/2 of it passes like gears.
    order = 5
    ripple = [{"shaft": "pinion", "order": order, "amplitude": 2.0, "phase": 90}]
    contact, touch = form.split()
    still = {"friction.coefficient": 0.0}
    pair = loaded.with_({"operating.torque_ripple": ripple, "mesh.contact": contact, **still})
    with pytest.raises(lumped.ParameterError, match="Add the inertia of motor"):  # swings by centimetres
        lumped.steady_state(pair.with_(operating__pinion_speed=200), contact=touch)
    run = lumped.steady_state(pair, samples_per_cycle=512, contact=touch)
    load = run.normal_load.sum("pair").values
    first = 2.0 * np.fft.rfft(load)[order] / load.size * pair.geometry.base_radius_pinion
    near = 5e-3 if contact == "loaded" else 0.1  # in fixed windows the load rings after each change
    assert abs(first) == pytest.approx(1.0, rel=near)
    assert np.angle(first) == pytest.approx(np.pi / 2.0, abs=near)


@pytest.mark.parametrize("name", UNLIKE)
def test_neighbours_move_each_other_with_loaded_contact_alone(name):
    """``write_elastic_loads`` asks for one of both: what moves neighbours is never prescribed."""
    pair = unlike_pair(name)
    loaded, prescribed = (
        ToothLaws(pair.with_({"mesh.contact": contact})).contact_law() for contact in ("loaded", "prescribed")
    )
    assert prescribed.prescribed
    assert not prescribed.coupled
    assert not loaded.prescribed
    # These two know the body under neighbouring teeth; a parabolic or a rectangular law is of one tooth pair.
    assert loaded.coupled == (pair.mesh.stiffness.model in ("energy", "finite_elements"))

"""Are the closed forms of the cases with one degree of freedom solutions of their equations?

Each is compared with DOP853, which knows nothing of it, and with what the equations of the gear pair say.
"""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import lumped
from lumped.errors import ParameterError
from lumped.model.equations import THETA_G, THETA_P, structure
from lumped.schema.bodies import bodies_of
from tests.unlike_pairs import unlike_pair
from validation.reference_cases.case import reference
from validation.reference_cases.definitions import DEFINITIONS
from validation.reference_cases.equations import InvolutePair, PiecewiseLinearMesh, equation_of, sliding_mesh
from validation.reference_cases.make import by_transition_matrices

ONE_DEGREE = [one for one in DEFINITIONS if one.equation is not None]


def integrated(equation, stiffness, time, start):
    """Motion from a start state by DOP853, anew in every smooth segment."""
    states = []
    for low, high in zip(equation.edges[:-1], equation.edges[1:], strict=True):
        inside = (time >= low) & (time < high)

        def rate(t, state, low=low, high=high):
            # Strictly inside the segment: at its ends the stiffness belongs to either side.
            k = stiffness(np.clip(t, low + 1e-12 * (high - low), high - 1e-12 * (high - low)))
            force = equation.force - equation.damping * state[1] - k * state[0]
            return np.array([state[1], force / equation.mass])

        atol = 1e-13 * np.array([1e-6, 1e-2])
        run = solve_ivp(
            rate, (low, high), start, "DOP853", np.append(time[inside], high), rtol=3e-14, atol=atol
        )
        states.append(run.y[:, :-1])
        start = run.y[:, -1]
    return np.hstack(states), start


def rectangular(table):
    """k(t) as the file says it in words."""
    step = (table["contact_ratio"] - 1.0) * table["period"]
    return lambda t: table["pair_stiffness"] * (2.0 if t < step else 1.0)


def cosine(table):
    mean, depth, period = (table[name] for name in ("mean_stiffness", "depth", "period"))
    return lambda t: mean * (1.0 + depth * np.cos(2.0 * np.pi * t / period))


def sliding(table):
    """k(t) from the moments of normal loads and friction forces on both gears, pair by pair."""
    r_p = table["base_radius_pinion"]
    r_g = table["base_radius_gear"]
    J_p = table["inertia_pinion"]
    J_g = table["inertia_gear"]
    mass = 1.0 / (r_p**2 / J_p + r_g**2 / J_g)

    def stiffness(t):
        total = 0.0
        for ahead in (0.0, 1.0):
            X = table["path_start"] + table["base_pitch"] * (t / table["period"] + ahead)
            beyond_pitch = X >= table["pitch_point"]  # noqa: SIM300
            in_contact = X < table["path_end"]  # noqa: SIM300
            if in_contact:
                N = table["pair_stiffness"]
                F = table["friction_coefficient"] * N * (1.0 if beyond_pitch else -1.0)
                pinion = (-r_p * N - X * F) / J_p
                gear = (r_g * N + (table["tangent_points"] - X) * F) / J_g
                total -= mass * (r_p * pinion - r_g * gear)
        return total

    return stiffness


STATED = {"rectangular": rectangular, "cosine": cosine, "sliding friction": sliding}


@pytest.mark.parametrize("definition", ONE_DEGREE, ids=lambda one: one.name)
def test_the_closed_form_is_what_an_integrator_finds(definition):
    equation = equation_of(definition.equation)
    stiffness = STATED[definition.equation["form"]](definition.equation)
    time = equation.period * np.arange(512) / 512
    exact = equation.motion(time)
    start = np.array([exact.dte[0], exact.dte_dot[0]])
    states, end = integrated(equation, stiffness, time, start)
    size = np.array([np.ptp(exact.dte), np.ptp(exact.dte_dot)])
    # DOP853 was asked for 3e-14 a step and takes some hundred steps.
    assert np.abs(states[0] - exact.dte).max() < 1e-11 * size[0]
    assert np.abs(states[1] - exact.dte_dot).max() < 1e-11 * size[1]
    assert (np.abs(end - start) < 1e-11 * size).all(), "the motion is periodic"


@pytest.mark.parametrize("definition", ONE_DEGREE, ids=lambda one: one.name)
def test_the_file_has_the_closed_form_and_contact_is_not_lost(definition):
    case = reference(definition.name)
    time = case.curves.places
    motion = case.equation.motion(time)
    (dte,) = case.curves.of_quantity("dte")
    assert np.abs(dte.values - motion.dte).max() <= 0.51e-7 * np.ptp(motion.dte)
    assert motion.dte.min() > 0.0
    assert time[0] == 0.0
    assert time[-1] == pytest.approx(case.mesh_period * (1.0 - 1.0 / 4096.0), rel=1e-9)


def numbers_of(pair):
    """Numbers of a gear pair for the equation with one degree of freedom."""
    g = pair.geometry
    b = bodies_of(pair)
    return InvolutePair(
        g.base_radius_pinion, g.base_radius_gear, b.inertia_pinion, b.inertia_gear, g.L_XA, g.L_XD,
        g.L_XP, g.L_XY, g.base_pitch,
    )  # fmt: skip


@pytest.mark.parametrize("name", ["larger_gear_drives_contact_lost", "rack_25_degrees_always_pushing"])
def test_the_arm_of_friction_is_that_of_the_model_with_six_degrees(name):
    """On rigid bearings the six equations are the one: its arm follows from their rows of both rotations."""
    pair = unlike_pair(name)
    numbers = numbers_of(pair)
    six = structure(pair)
    position = np.linspace(numbers.path_start, numbers.path_end, 7)
    turns = [THETA_P, THETA_G]
    along = six.deflection[turns] / six.mass[turns]
    assert numbers.effective_mass == pytest.approx(-1.0 / (along @ six.normal[turns]), rel=1e-13)
    arms = -numbers.effective_mass * six.friction(position)[:, turns] @ along
    np.testing.assert_allclose(numbers.friction_arm(position), arms, rtol=1e-12)


def test_equal_gears_need_no_airy_functions_and_lie_on_their_limit():
    """With equal inertias and unity ratio the stiffness is constant between events.

    A ratio that differs by 1e-6 takes Airy's functions at arguments of 1e4 and more. The motion may differ
    by that ratio only.
    """
    equal = {
        "base_radius_pinion": 0.04, "base_radius_gear": 0.04, "inertia_pinion": 8e-4, "inertia_gear": 8e-4,
        "path_start": 0.0078, "path_end": 0.0226, "pitch_point": 0.0152, "tangent_points": 0.0304,
        "base_pitch": 0.0093,
    }  # fmt: skip
    how = {"pair_stiffness": 3e8, "friction_coefficient": 0.08, "damping": 1500.0, "force": 900.0}
    motions = []
    for change in (0.0, 1e-3):
        pair = InvolutePair(**equal)._replace(inertia_gear=8e-4 * (1.0 + change))
        mesh = sliding_mesh(pair, period=6e-4, **how)
        assert isinstance(mesh, PiecewiseLinearMesh)
        assert (mesh.stiffness_start == mesh.stiffness_end).all() == (change == 0.0)
        motions.append(mesh.motion(np.linspace(0.0, 5.9e-4, 200)).dte)
    difference = np.abs(motions[1] - motions[0]).max() / np.ptp(motions[0])
    assert 1e-5 < difference < 3e-2


def test_a_contact_ratio_above_two_is_refused():
    table = next(one.equation for one in DEFINITIONS if one.name == "sliding_friction")
    with pytest.raises(ParameterError, match=r"contact ratio = .*between 1 and 2"):
        equation_of({**table, "path_end": table["path_start"] + 2.1 * table["base_pitch"]})


@pytest.mark.parametrize("name", ["larger_gear_drives_contact_lost", "rack_25_degrees_always_pushing"])
@pytest.mark.parametrize("friction_coefficient", [0.0, 0.1])
def test_six_degrees_on_stiff_bearings_approach_the_closed_form(name, friction_coefficient):
    """The give of the bearings is k/K: bearings twice as stiff halve the difference.

    The tooth dampers of the model follow the stiffness, so they are left out on both sides. The period is not
    the resonance of an order, and the mean brake torque is that of the model with six degrees.
    """
    pair = unlike_pair(name).with_(
        mesh__contact="prescribed", mesh__relief="ignored", mesh__stiffness={"model": "rectangular"},
        mesh__damping_ratio=0.0, law="coulomb", friction__coefficient=friction_coefficient, speed=2900,
    )  # fmt: skip
    numbers = numbers_of(pair)
    operating = pair.operating
    differences = []
    for factor in (2000.0, 4000.0):
        k = float(lumped.mesh_stiffness(pair)["mesh_stiffness"].min())
        ends = [f"bearings.{end}.{axis}" for end in ("pinion", "gear") for axis in ("loa", "oloa")]
        stiff = pair.with_({f"{one}_stiffness": factor * k for one in ends})
        stiff = stiff.with_({f"{one}_damping_ratio": 0.5 for one in ends})
        motion = lumped.steady_state(stiff, supports="springs", samples_per_cycle=256)
        torques = operating.pinion_torque * numbers.base_radius_pinion / numbers.inertia_pinion
        torques += motion.attrs["brake_torque"] * numbers.base_radius_gear / numbers.inertia_gear
        mesh = sliding_mesh(
            numbers, pair_stiffness=k, friction_coefficient=friction_coefficient, damping=0.0,
            force=numbers.effective_mass * torques, period=pair.geometry.mesh_period,
        )  # fmt: skip
        exact = mesh.motion(motion["time"].to_numpy()).dte
        differences.append((motion["dte"].to_numpy() - exact) / np.ptp(exact))
    coarse, fine = (np.abs(one).max() for one in differences)
    assert fine < 1e-2
    assert coarse / fine == pytest.approx(2.0, rel=0.1)
    # In the limit the closed form remains; the bearings ring after a jump, which is no multiple of k/K.
    assert np.abs(2.0 * differences[1] - differences[0]).max() < 3e-4


@pytest.mark.parametrize("definition", ONE_DEGREE, ids=lambda one: one.name)
def test_transition_matrices_give_the_closed_form(definition):
    equation = equation_of(definition.equation)
    time = equation.period * np.arange(256) / 256
    motion = equation.motion(time)
    dte, dte_dot = by_transition_matrices(equation, time).T
    # The matrices were asked for 1e-12 of the period's matrix.
    assert np.abs(dte - motion.dte).max() < 1e-11 * np.abs(motion.dte).max()
    assert np.abs(dte_dot - motion.dte_dot).max() < 1e-11 * np.abs(motion.dte_dot).max()

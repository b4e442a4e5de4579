"""The machine on shafts: is it what its equations say, and the pair on springs where its shafts are stiff?"""

import itertools

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import lumped
import multibody
from lumped.errors import ParameterError
from lumped.stiffness.foundation import body_twist
from multibody.contact import kinematics as kn
from multibody.contact.kernels import tooth_forces
from multibody.contact.records import CONTACTS_SIZE, WRENCH, X_G, X_P, Y_G, Y_P, opened
from multibody.run.linear_motion import state_scale
from multibody.run.setup import prepare
from multibody.run.simulation import record
from multibody.shafts.train import disc


def bearing(position, loa, oloa, **damping):
    return {"position": position, "loa_stiffness": loa, "oloa_stiffness": oloa} | damping


#: No two of a kind alike; the pinion is overhung, and bends and tilts.
SHAFTS = {
    "damping_ratio": 0.02,
    "max_frequency": 12e3,
    "pinion": {"segments": [{"length": 100, "diameter": 30}, {"length": 60, "diameter": 25, "bore": 8}],
     "gear_position": 145, "bearings": [bearing(20, 2e8, 1.6e8, loa_damping=300.0), bearing(90, 3e8, 2e8)]},
    "gear": {"segments": [{"length": 120, "diameter": 35}], "gear_position": 30, "bearings": [bearing(10,
     1.5e8, 2.5e8), bearing(105, 2e8, 1e8, oloa_damping=200.0)]},
    "motor": {"position": 0, "inertia": 0.004, "coupling_stiffness": 4e4, "coupling_damping": 0.2},
    "load": {"position": 120, "inertia": 0.02, "coupling_stiffness": 2e4},
}  # fmt: skip
PAIR = lumped.load_gear_pair("nasa_28_28").with_(
    mesh__contact="prescribed",
    mesh__relief="ignored", friction__law="coulomb", friction__coefficient=0.06, shafts=SHAFTS, gear__bore=40,
    mesh__stiffness={"model": "finite_elements"},
)  # fmt: skip


@pytest.fixture(scope="module")
def setup():
    """Periodic linear motion on few modes."""
    return prepare(PAIR, "linear", "periodic", supports="shafts")


@pytest.fixture(scope="module")
def run(setup):
    return record(setup, 1, 64)


def test_exudyn_solves_the_equations_of_the_machine(setup, run):
    """scipy's DOP853 on M q'' + D q' + K q = f with the same tooth forces, from switch to switch."""
    m = setup.machine
    train = setup.machine.train
    n = m.size
    packed = m.packed.copy()
    rolling = opened(packed).rolling
    gears = np.empty((3, 6))
    contacts = np.zeros(CONTACTS_SIZE)
    load = -np.array([m.torque_pinion, m.torque_gear]) @ train.torques

    def rates(t, state):
        q = state[:n]
        v = state[n:]
        gears[:2] = q[:6], v[:6]
        tooth_forces(t, gears, packed, kn.LINEAR, contacts)
        force = load - train.stiffness @ q - train.damping @ v
        force[:6] += gears[WRENCH]
        return np.concatenate([v, np.linalg.solve(train.mass, force)])

    state = np.concatenate([setup.q, setup.v])
    edges = setup.edges(1)
    for start, stop in itertools.pairwise(edges):
        rolling.earliest = start + 1e-12 * m.period
        rolling.latest = stop - 1e-12 * m.period
        state = solve_ivp(rates, (start, stop), state, method="DOP853", rtol=1e-9, atol=1e-13).y[:, -1]
    motion, q, v = run
    span = float(np.ptp(motion["dte"].to_numpy()))
    units = state_scale(m, 1.0)[:n]
    # 9e-4 nm in a prototype; here both integrators stay below 1e-7 of the motion.
    assert np.abs(q - state[:n]).max() < 1e-6 * span
    assert np.abs((q - state[:n])[:6] / units[:6]).max() < 1e-7 * span
    # And the motion that was found without exudyn and without scipy is periodic in exudyn.
    assert np.abs((q - setup.q) / units).max() < 1e-7 * span
    assert np.abs((v - setup.v) / units).max() < 1e-6 * span * 2 * np.pi / m.period


@pytest.mark.parametrize(("shaft", "order", "other"), [("pinion", 5, "gear"), ("gear", 9, "pinion")])
def test_a_ripple_is_that_of_motor_or_load_in_both_models(shaft, order, other):
    one = {"shaft": shaft, "order": order, "amplitude": 8.0, "phase": 40}
    more = {"mesh.contact": "loaded", "mesh.stiffness": "rectangular", "friction.coefficient": 0.0}
    more |= {"operating.pinion_speed": 1450, "shafts.max_frequency": 2e3}  # far above the ripples
    more |= {"shafts.damping_ratio": 0.1}  # both motions settle sooner
    pair = PAIR.with_(more | {"operating.torque_ripple": [one]})
    exact = record(prepare(pair, "exact", "periodic", supports="shafts"), 9, 16)[0].dte.values[48:]
    # The lumped motion is the quick one to compute, so it is the one with another ripple.
    for wrong in {}, {"phase": 70}, {"order": order + 1}, {"shaft": other}:
        other_pair = pair.with_({"operating.torque_ripple": [one | wrong]})
        run = lumped.steady_state(other_pair, contact="unilateral", samples_per_cycle=16).dte.values[48:145]
        # Finite rotations leave 2.5 and 2.9 %, the least of the others 7.8 %.
        assert (np.abs(exact - run).max() < 0.04 * np.ptp(exact)) == (not wrong), wrong


def test_gears_are_discs_on_shafts_that_turn_against_each_other(setup):
    """The gyroscopic moment between both planes has the sign of the rotation. The pinion turns clockwise.

    A gear that moves along x tilts like a gear that moves along y, overhung or not.
    """
    train = setup.machine.train
    m = setup.machine
    turning = train.damping - train.damping.T
    assert turning[X_P, Y_P] < 0.0 < turning[X_G, Y_G]
    body = disc(PAIR, 1, m.mass[1], m.inertia[1])
    width = PAIR.gear.face_width
    radius = PAIR.geometry.reference_radius_gear
    hole = PAIR.gear.bore / 2
    assert body.tilting == pytest.approx(m.mass[1] * (3 * (radius**2 + hole**2) + width**2) / 12, rel=1e-12)
    assert body.twist_stiffness == pytest.approx(body_twist(PAIR)[1], rel=1e-12)
    assert np.isinf(disc(PAIR, 0, m.mass[0], m.inertia[0]).twist_stiffness)


def test_bearings_hold_what_teeth_push(run):
    """Mean forces: those of all bearings of a shaft against the teeth, the nearer bearing of the overhung
    pinion more than the load, by the lever 125/70; the brake takes what friction leaves.
    """
    mean = run[0].isel(time=slice(None, -1)).mean("time")
    load = float(mean["normal_load"].sum())
    friction = float(mean["friction_force"].sum())
    for gear, sign in (("p", 1.0), ("g", -1.0)):
        assert float(mean[f"bearing_force_x_{gear}"]) == pytest.approx(sign * load, rel=1e-2)
        assert float(mean[f"bearing_force_y_{gear}"]) == pytest.approx(-sign * friction, abs=1e-2 * load)
    force = mean["bearing_force"].sel(direction="loa")
    assert float(force.sel(bearing="pinion 2")) == pytest.approx(load * 125 / 70, rel=1e-2)
    assert float(force.sel(bearing="gear 1")) == pytest.approx(-load * 75 / 95, rel=1e-2)
    assert list(force["bearing"].to_numpy()) == ["pinion 1", "pinion 2", "gear 1", "gear 2"]
    assert 0.98 < run[0].attrs["mesh_efficiency"] < 1.0


def stiff(pair):
    """Shafts that neither bend nor twist, a half of ``pair.bearings`` on both sides; and a pair as heavy."""
    weight = 7850 * np.pi / 4 * 0.04**2 * 0.03
    body = lumped.bodies(pair)
    tables = {}
    turning = weight * 0.02**2 / 2
    more = {"pinion.mass": body.mass_pinion + weight, "gear.mass": body.mass_gear + weight}
    more |= {"pinion.inertia": body.inertia_pinion + turning, "gear.inertia": body.inertia_gear + turning}
    springs = pair.with_(more)
    heavier = lumped.bodies(springs)
    # The damper of the teeth is that of the gears alone.
    share = np.sqrt(body.effective_mass / heavier.effective_mass)
    springs = springs.with_(mesh__damping_ratio=pair.mesh.damping_ratio * share)
    for name in ("pinion", "gear"):
        bearing_of_pair = getattr(pair.bearings, name)
        mass = getattr(heavier, f"mass_{name}")
        half = {}
        for axis in ("loa", "oloa"):
            k = getattr(bearing_of_pair, f"{axis}_stiffness")
            half[f"{axis}_stiffness"] = 0.5 * k
            half[f"{axis}_damping"] = getattr(bearing_of_pair, f"{axis}_damping_ratio") * np.sqrt(k * mass)
        bearings = [half | {"position": position} for position in (5, 25)]
        tables[name] = {
            "segments": [{"length": 30, "diameter": 40}],
            "gear_position": 15,
            "bearings": bearings,
        }
    shafts = pair.with_(shafts={"damping_ratio": 0.0, **tables}).shafts
    rigid = {name: getattr(shafts, name).model_copy(update={"youngs_modulus": 1e15}) for name in tables}
    sections = {name: getattr(pair, name) for name in type(pair).model_fields}
    sections["shafts"] = shafts.model_copy(update=rigid)
    return type(pair).model_construct(**sections), springs


@pytest.mark.parametrize("fidelity", ["linear", "exact"])
def test_stiff_shafts_are_the_springs_of_the_6_dof_model(fidelity):
    pair = lumped.load_gear_pair("nasa_28_28").with_(mesh__contact="prescribed", mesh__relief="ignored")
    on_shafts, on_springs = stiff(pair)
    run = multibody.simulate(on_shafts, 2, fidelity=fidelity, supports="shafts", samples_per_cycle=64)
    other = multibody.simulate(on_springs, 2, fidelity=fidelity, samples_per_cycle=64)
    for name in ("dte", "x_p", "y_p", "x_g", "y_g", "bearing_force_x_p", "bearing_force_y_g"):
        error = float(np.abs(run[name] - other[name]).max())
        # Of the shafts' own compliance, 1e-6 of that of the bearings, a resonance makes some more.
        assert error < 1e-5 * float(np.abs(other[name]).max()), name


def test_both_models_see_the_same_pair_on_shafts(run):
    """Beams, reduction, gyroscopic moments, dampers, couplings and contact are worked out twice; the modes
    that are kept are the same. Two-node elements leave some 1e-9 of the frequencies. Both read k from plane
    finite elements.
    """
    multibody_motion = run[0].isel(time=slice(None, -1))
    lumped_run = lumped.steady_state(PAIR, supports="shafts", samples_per_cycle=64)
    assert multibody_motion.attrs["brake_torque"] == pytest.approx(lumped_run.attrs["brake_torque"], rel=1e-9)
    for name in ("dte", "x_p", "y_p", "x_g", "y_g", "normal_load", "bearing_force", "bearing_force_y_g"):
        span = float(np.ptp(lumped_run[name].to_numpy()))
        assert float(np.abs(multibody_motion[name] - lumped_run[name].to_numpy()).max()) < 1e-6 * span, name


def test_on_shafts_too_the_brake_of_the_loaded_form_supplies_every_loss():
    pair = PAIR.with_(mesh__stiffness={"model": "energy"}, mesh__contact="loaded")
    machine = prepare(pair, initial="periodic", supports="shafts").machine
    expected = lumped.steady_state(pair, supports="shafts", samples_per_cycle=16).attrs
    lost = expected["pinion_torque"] - expected["brake_torque"]  # equal gears
    # Simpson's rule over steps in which dampers take hold leaves 6e-5; the paper's brake leaves out 5 %.
    assert machine.torque_pinion - machine.torque_gear == pytest.approx(lost, rel=2e-4)
    assert expected["power_sliding"] < 0.96 * lost * pair.operating.pinion_speed


def test_finite_motions_on_shafts_fall_with_torque():
    """The exact periodic motion differs from the lumped motion by the change of the geometry by deflections.

    At a fourth of the torque the difference over the swing is a fourth.
    """
    differences = []
    for torque in (16.0, 4.0):
        pair = PAIR.with_(operating__pinion_torque=torque, mesh__stiffness={"model": "rectangular"})
        exact = multibody.steady_state(pair, supports="shafts", samples_per_cycle=64)
        linear = lumped.steady_state(pair, supports="shafts", samples_per_cycle=64)
        assert exact.attrs["closure"] < 1e-7
        difference = np.abs(exact["dte"].to_numpy() - linear["dte"].to_numpy()).max()
        differences.append(float(difference / np.ptp(linear["dte"].to_numpy())))
    assert 1e-3 < differences[1] < 1e-2
    assert differences[0] / differences[1] == pytest.approx(4.0, rel=0.02)


def test_refusals():
    plain = lumped.load_gear_pair("nasa_28_28").with_(mesh__contact="prescribed")
    with pytest.raises(ParameterError, match="supports"):
        multibody.simulate(plain, 1, supports="shafts")
    with pytest.raises(ParameterError, match="'static' or 'periodic'"):
        multibody.simulate(PAIR, 1, supports="shafts", initial=np.zeros(12))
    damped = PAIR.with_({"shafts.pinion.bearings.0.loa_damping": 1e9})
    with pytest.raises(ParameterError, match="a damper that answers within"):
        multibody.simulate(damped, 1, supports="shafts")

"""Is a pair on shafts what it must be where that is known: a pair on springs, and balanced forces?"""

import math

import numpy as np
import pytest
from scipy.linalg import eigh

from lumped import (
    ParameterError,
    bodies,
    condensed_bearings,
    mesh_cycle,
    periodic_system,
    shaft_modes,
    simulate,
    steady_state,
)
from lumped.shafts.beam import Piece, beam
from lumped.shafts.pair import discs


def test_rigid_shafts_are_the_springs(unlike, on_short_shafts):
    pair = unlike.healthy.with_(shafts=None)
    springs = steady_state(pair, samples_per_cycle=64)
    shafts = steady_state(on_short_shafts(pair), samples_per_cycle=64, supports="shafts")
    # Tooth dampers follow from the inertia of the gear alone, from which that of the shaft was taken: 1e-4.
    names = ("dte", "x_p", "y_g", "theta_p_dot", "normal_load", "bearing_force_x_g", "bearing_force_y_p")
    for name in names:
        size = float(np.abs(springs[name]).max())
        assert float(np.abs(shafts[name] - springs[name]).max()) < 1e-4 * size, name
    for name in ("brake_torque", "power_sliding", "power_bearings", "spectral_radius", "dte_peak_to_peak"):
        assert shafts.attrs[name] == pytest.approx(springs.attrs[name], rel=1e-4), name
    assert shafts.attrs["power_shafts"] == 0.0
    assert shafts.attrs["supports"] == "shafts"
    assert list(shafts.bearing.to_numpy()) == ["pinion 1", "gear 1"]
    np.testing.assert_array_equal(shafts.bearing_force[1, 0], shafts.bearing_force_x_g)


def test_motion_on_elastic_shafts(shafted):
    run = steady_state(shafted, samples_per_cycle=64, supports="shafts")
    assert run.attrs["error_estimate"] < 1e-6
    assert run.attrs["spectral_radius"] < 1.0
    assert run.attrs["power_bearings"] > 0.0
    assert run.attrs["power_shafts"] > 0.0
    assert list(run.bearing.to_numpy()) == ["pinion 1", "pinion 2", "gear 1"]
    # A transient from the periodic state stays, and one from rest does not.
    system = periodic_system(shafted, "full", supports="shafts")
    motion = simulate(shafted, 2, samples_per_cycle=64, initial="periodic", supports="shafts")
    for part in (motion.isel(time=slice(0, 64)), motion.isel(time=slice(64, 128))):
        size = float(np.abs(run.dte).max())
        np.testing.assert_allclose(part.dte, run.dte, rtol=0, atol=1e-9 * size)
    assert np.abs(motion.dte[0] - motion.dte[128]) < 1e-9 * size
    # At rest under the mean load, bearings and teeth bear it: moments about a bearing give the other's force.
    rest = simulate(shafted, 1, samples_per_cycle=8, supports="shafts").isel(time=0)
    load = shafted.operating.pinion_torque / shafted.geometry.base_radius_pinion
    assert rest.bearing_force.sel(bearing="gear 1", direction="loa") == pytest.approx(-load, rel=1e-9)
    second = load * (90.1 - 30.1) / (151 - 30.1)
    assert rest.bearing_force.sel(bearing="pinion 2", direction="loa") == pytest.approx(second, rel=1e-6)
    assert rest.dte * system.cycle.mean_stiffness == pytest.approx(load, rel=1e-9)


def test_every_form_is_the_same_system(shafted):
    full, relative, feedback = (
        periodic_system(shafted, form, supports="shafts") for form in ("full", "elastic", "mesh")
    )
    m = len(full.coordinates)
    keep = np.delete(np.arange(2 * m), [0, m])
    time = 0.3 * full.period
    for other in (relative, feedback):
        np.testing.assert_array_equal(full.A(time)[np.ix_(keep, keep)], other.A(time))
    assert not full.A(time)[:, 0].any()  # the common rotation is felt by nobody
    # Opposite senses: the moments of the pinion's and the gear's shaft have opposite signs.
    gyroscopic = full.gyroscopic
    owner = full.supports.modes.shaft
    kind = full.supports.modes.kind
    np.testing.assert_array_equal(gyroscopic, -gyroscopic.T)
    signs = [
        np.trace(gyroscopic[np.ix_((owner == j) & (kind == 0), (owner == j) & (kind == 1))]) for j in (0, 1)
    ]
    assert signs[0] < 0.0 < signs[1]


def test_without_shafts_there_are_none(unequal):
    for function in (steady_state, lambda pair, supports: periodic_system(pair, supports=supports)):
        with pytest.raises(ParameterError, match=r"springs for a pair without \[shafts\]"):
            function(unequal, supports="shafts")
    with pytest.raises(ParameterError, match="springs, shafts"):
        periodic_system(unequal, supports="shaft")


def test_shafts_under_springs_are_the_springs(unequal, on_short_shafts):
    pair = unequal.with_({"bearings.gear.oloa_damping_ratio": 0.4})
    again = condensed_bearings(on_short_shafts(pair))
    for name in ("pinion", "gear"):
        for field in ("loa_stiffness", "oloa_stiffness", "loa_damping_ratio", "oloa_damping_ratio"):
            expected = getattr(getattr(pair.bearings, name), field)
            assert getattr(getattr(again.bearings, name), field) == pytest.approx(expected, rel=1e-4), field
        for kind in ("mass", "inertia"):
            spring = getattr(getattr(again, name), kind)
            assert spring == pytest.approx(getattr(bodies(pair), f"{kind}_{name}"), rel=1e-6)
    assert again.shafts is None


def resistance(pair, omega, direction="loa"):
    """Dynamic stiffness of the pinion in a direction and of its rim, from all matrices of the shaft.

    Damping is M Phi diag(2 zeta omega_i) Phi^T M, with all modes Phi of unit modal mass, and the dashpots.
    """
    shaft = pair.shafts.pinion
    disc = discs(pair)[0]
    motor = pair.shafts.motor
    pieces = [Piece(s.length, s.diameter, s.bore, 206e9, 0.3, 7850.0) for s in shaft.segments]
    mesh = beam(pieces, [shaft.gear_position, *(b.position for b in shaft.bearings)], 1e5, 0.5)
    gear = mesh.node(shaft.gear_position)
    n = mesh.twist_mass.shape[0]
    stiffness = mesh.stiffness.copy()
    mass = mesh.mass.copy()
    mass[[2 * gear, 2 * gear + 1], [2 * gear, 2 * gear + 1]] += disc.mass, disc.tilting
    rows = [2 * mesh.node(b.position) for b in shaft.bearings]
    stiffness[rows, rows] += [getattr(b, f"{direction}_stiffness") for b in shaft.bearings]
    squares, modes = eigh(stiffness, mass)
    damping = mass @ modes * (2.0 * pair.shafts.damping_ratio * np.sqrt(squares)) @ modes.T @ mass
    damping[rows, rows] += [getattr(b, f"{direction}_damping") for b in shaft.bearings]
    bending = stiffness - omega**2 * mass + 1j * omega * damping
    twist = np.zeros((n + 1, n + 1))
    twist[:n, :n] = mesh.twist_stiffness - omega**2 * mesh.twist_mass
    twist[gear, gear] -= omega**2 * disc.inertia
    spring = motor.coupling_stiffness
    twist[np.ix_([0, n], [0, n])] += spring * np.array([[1, -1], [-1, 1]])
    twist[n, n] -= omega**2 * motor.inertia
    return 1 / np.linalg.inv(bending)[2 * gear, 2 * gear], 1 / np.linalg.inv(twist)[gear, gear]


@pytest.mark.parametrize("frequency", [0.0, 60.0, 2600.0])
def test_condensed_gears_feel_their_shafts(shafted, frequency):
    shafted = shafted.with_({"shafts.max_frequency": 50_000})
    pair = condensed_bearings(shafted, frequency)
    omega = 2 * math.pi * frequency
    omega_of_ratio = omega or 10.0
    turning = resistance(shafted, omega_of_ratio)[1]
    assert -(omega_of_ratio**2) * pair.pinion.inertia == pytest.approx(turning, rel=2e-3)
    for direction in ("loa", "oloa"):
        bearing = resistance(shafted, omega_of_ratio, direction)[0]
        stiffness = getattr(pair.bearings.pinion, f"{direction}_stiffness")
        assert stiffness - omega**2 * pair.pinion.mass == pytest.approx(bearing.real, rel=2e-3)
        ratio = getattr(pair.bearings.pinion, f"{direction}_damping_ratio")
        damping = 2.0 * ratio * math.sqrt(stiffness * pair.pinion.mass)
        assert damping == pytest.approx(bearing.imag / omega_of_ratio, rel=2e-3)
    near, far = (0.999 * omega, 1.001 * omega) if omega else (10.0, 100.0)
    slope = (resistance(shafted, far)[0] - resistance(shafted, near)[0]).real / (far**2 - near**2)
    assert pair.pinion.mass == pytest.approx(-slope, rel=1e-3)


def test_no_spring_above_a_resonance(shafted):
    with pytest.raises(ParameterError, match="pinion's shaft resists like a spring"):
        condensed_bearings(shafted, 700.0)
    with pytest.raises(ParameterError, match="frequency"):
        condensed_bearings(shafted, -1.0)


def test_modes_of_the_pair(unequal, shafted, on_short_shafts):
    modes = shaft_modes(on_short_shafts(unequal))
    b = bodies(unequal)
    k = mesh_cycle(unequal).mean_stiffness
    pinion, gear = unequal.bearings.pinion, unequal.bearings.gear
    # q, x_p, x_g of the 6-DOF model in units of root mass; y of both gears by themselves.
    u = np.array([1 / math.sqrt(b.effective_mass), 1 / math.sqrt(b.mass_pinion), -1 / math.sqrt(b.mass_gear)])
    matrix = k * np.outer(u, u)
    matrix += np.diag([0, pinion.loa_stiffness / b.mass_pinion, gear.loa_stiffness / b.mass_gear])
    squares = [*np.linalg.eigvalsh(matrix), pinion.oloa_stiffness / b.mass_pinion]
    squares = np.sort([*squares, gear.oloa_stiffness / b.mass_gear])
    np.testing.assert_allclose(modes.natural_frequency, np.sqrt(squares) / (2 * math.pi), rtol=5e-3)
    assert set(modes.name.to_numpy()) >= {"tooth mesh", "pinion shaft in bearings along y"}
    elastic = shaft_modes(shafted)
    for share in (modes.elastic_share, elastic.elastic_share, modes.kinetic_share, elastic.kinetic_share):
        np.testing.assert_allclose(share.sum("part"), 1.0, rtol=1e-12)
    names = list(elastic.name.to_numpy())
    assert {"torsion", "tooth mesh"} < set(names)
    assert any("bending" in name for name in names)
    assert (elastic.damping_ratio > 0.005).all()


def test_each_gear_is_a_disc_of_its_own_on_its_shaft(unlike):
    """J/2 + m b^2/12 against tilting, with the whole face width; its body twists on the shaft."""
    b = bodies(unlike)
    expected = (
        (unlike.pinion, b.mass_pinion, b.inertia_pinion),
        (unlike.gear, b.mass_gear, b.inertia_gear),
    )
    for gear_index, (gear, mass, inertia) in enumerate(expected):
        disc = discs(unlike)[gear_index]
        assert (disc.mass, disc.inertia) == (mass, inertia)
        assert disc.tilting == pytest.approx(0.5 * inertia + mass * gear.face_width**2 / 12.0, rel=1e-12)


def test_each_gear_whirls_at_the_speed_of_its_own_shaft(unlike, on_short_shafts):
    """A disc tilts on springs at two frequencies, forward and backward: they are J Omega/J_t apart.

    With phi = phi_x + i phi_y: J_t phi'' - i J Omega phi' + K phi = 0, so the difference of the roots' moduli
    is J Omega/J_t whatever K is.
    """
    pair = unlike.healthy.with_(shafts=None)
    tilts = 1e5  # [rad/s], far from every other frequency
    of_gears = discs(pair)
    springs = {
        f"shafts.{gear}.bearings.0.tilt_stiffness": disc.tilting * tilts**2
        for gear, disc in zip(("pinion", "gear"), of_gears, strict=True)
    }
    on_springs = on_short_shafts(pair).with_(springs | {"shafts.max_frequency": 25_000})
    modes = periodic_system(on_springs, "full", supports="shafts").supports.modes
    speed = 2.0 * math.pi * 20_000 / 60.0  # of the pinion
    teeth = pair.pinion.teeth, pair.gear.teeth
    for number, disc in enumerate(of_gears):
        bending = (modes.shaft == number) & (modes.kind < 2)
        count = int(bending.sum())
        matrix = np.block([
            [np.zeros((count, count)), np.eye(count)],
            [-np.diag(modes.frequencies[bending] ** 2), -speed * modes.gyroscopic[np.ix_(bending, bending)]],
        ])  # fmt: skip
        frequencies = np.abs(np.linalg.eigvals(matrix).imag)
        whirls = frequencies[np.abs(frequencies - tilts) < 0.1 * tilts]
        assert whirls.size == 4  # each beside its complex conjugate
        expected = disc.inertia / disc.tilting * speed * teeth[0] / teeth[number]
        # The light shaft bends a little and turns with the disc.
        assert np.ptp(whirls) == pytest.approx(expected, rel=1e-3)

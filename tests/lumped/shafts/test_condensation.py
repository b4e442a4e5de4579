"""Do condensed springs resist as the shafts do, and do the modes of the pair have their energy in place?"""

import math

import numpy as np
import pytest
from scipy.linalg import eigh

from lumped import ParameterError, bodies, condensed_bearings, mesh_cycle, shaft_modes
from lumped.shafts.beam import Piece, beam
from lumped.shafts.pair import discs


def test_shafts_under_springs_are_the_springs(unequal, on_short_shafts):
    pair = unequal.with_({"bearings.gear.oloa_damping_ratio": 0.4})
    again = condensed_bearings(on_short_shafts(pair))
    for name in ("pinion", "gear"):
        for field in ("loa_stiffness", "oloa_stiffness", "loa_damping_ratio", "oloa_damping_ratio"):
            expected = getattr(getattr(pair.bearings, name), field)
            assert getattr(getattr(again.bearings, name), field) == pytest.approx(expected, rel=1e-4), field
        for kind in ("mass", "inertia"):
            given = getattr(getattr(again, name), kind)
            assert given == pytest.approx(getattr(bodies(pair), f"{kind}_{name}"), rel=1e-6)
    assert again.shafts is None


def resistance(pair, omega, direction="loa"):
    """Dynamic stiffness of the pinion in a direction and of its rim, from all matrices of the shaft.

    Damping is M Phi diag(2 zeta omega_i) Phi^T M, with all modes Phi of unit modal mass, and the dashpots.
    """
    shaft, disc, motor = pair.shafts.pinion, discs(pair)[0], pair.shafts.motor
    pieces = [Piece(s.length, s.diameter, s.bore, 206e9, 0.3, 7850.0) for s in shaft.segments]
    mesh = beam(pieces, [shaft.gear_position, *(b.position for b in shaft.bearings)], 1e5, 0.5)
    gear, n = mesh.node(shaft.gear_position), mesh.twist_mass.shape[0]
    stiffness, mass = mesh.stiffness.copy(), mesh.mass.copy()
    mass[[2 * gear, 2 * gear + 1], [2 * gear, 2 * gear + 1]] += disc.mass, disc.tilting
    at = [2 * mesh.node(b.position) for b in shaft.bearings]
    stiffness[at, at] += [getattr(b, f"{direction}_stiffness") for b in shaft.bearings]
    squares, modes = eigh(stiffness, mass)
    damping = mass @ modes * (2.0 * pair.shafts.damping_ratio * np.sqrt(squares)) @ modes.T @ mass
    damping[at, at] += [getattr(b, f"{direction}_damping") for b in shaft.bearings]
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
    pair, omega = condensed_bearings(shafted, frequency), 2 * math.pi * frequency
    at = omega or 10.0
    turning = resistance(shafted, at)[1]
    assert -(at**2) * pair.pinion.inertia == pytest.approx(turning, rel=2e-3)
    for direction in ("loa", "oloa"):
        bearing = resistance(shafted, at, direction)[0]
        stiffness = getattr(pair.bearings.pinion, f"{direction}_stiffness")
        assert stiffness - omega**2 * pair.pinion.mass == pytest.approx(bearing.real, rel=2e-3)
        ratio = getattr(pair.bearings.pinion, f"{direction}_damping_ratio")
        damping = 2.0 * ratio * math.sqrt(stiffness * pair.pinion.mass)
        assert damping == pytest.approx(bearing.imag / at, rel=2e-3)
    near, far = (0.999 * omega, 1.001 * omega) if omega else (10.0, 100.0)
    slope = (resistance(shafted, far)[0] - resistance(shafted, near)[0]).real / (far**2 - near**2)
    assert pair.pinion.mass == pytest.approx(-slope, rel=1e-3)


def test_a_gear_tilts_as_a_disc_of_its_mass_inertia_and_width(shafted):
    assert discs(shafted)[0].tilting == pytest.approx(0.5 * 2.1e-4 + 0.25 * 6.35e-3**2 / 12, rel=1e-12)


def test_no_spring_above_a_resonance(shafted):
    with pytest.raises(ParameterError, match="pinion's shaft resists like a spring"):
        condensed_bearings(shafted, 700.0)
    with pytest.raises(ParameterError, match="frequency"):
        condensed_bearings(shafted, -1.0)


def test_modes_of_the_pair(unequal, shafted, on_short_shafts):
    modes = shaft_modes(on_short_shafts(unequal))
    b, k = bodies(unequal), mesh_cycle(unequal).mean_stiffness
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

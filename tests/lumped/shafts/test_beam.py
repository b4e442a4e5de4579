"""Do the elements have the exact frequencies and deflections of beams, of torsion, of a whirling disc?"""

import math

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.optimize import brentq

from lumped.schema.shafts import CoupledInertia, Shaft
from lumped.shafts.beam import Piece, beam
from lumped.shafts.supported import Disc, supported_shaft

LENGTH = 0.2
HOLLOW = Piece(LENGTH, 0.06, 0.02, 206e9, 0.3, 7850.0)
HIGHEST = 2 * math.pi * 20e3
MESH = beam([HOLLOW], [], HIGHEST, 0.4)


def frequencies(mass, stiffness, fixed):
    free = np.delete(np.arange(mass.shape[0]), fixed)
    values = eigh(stiffness[np.ix_(free, free)], mass[np.ix_(free, free)], eigvals_only=True)
    return np.sqrt(values[values > 1e3])


def timoshenko(omega):
    """Wave numbers a (of cosh), b (of cos), and slope over deflection of each (Huang 1961)."""
    flexural = HOLLOW.youngs_modulus * HOLLOW.second_moment
    line = HOLLOW.density * HOLLOW.area
    rotary = HOLLOW.density * HOLLOW.second_moment
    shear = HOLLOW.shear_rigidity
    half = 0.5 * omega**2 * (line / shear + rotary / flexural)
    root = math.sqrt(0.25 * omega**4 * (line / shear - rotary / flexural) ** 2 + omega**2 * line / flexural)
    a = math.sqrt(root - half)
    b = math.sqrt(root + half)
    inertia = omega**2 * line / shear
    return a, b, (a * a + inertia) / a, (b * b - inertia) / b


def determinant(omega, ends):
    """Of the conditions at both ends on w = c1 cosh az + c2 sinh az + c3 cos bz + c4 sin bz."""
    a, b, p, q = timoshenko(omega)

    def rows(z, end):
        ch = math.cosh(a * z)
        sh = math.sinh(a * z)
        co = math.cos(b * z)
        si = math.sin(b * z)
        w = [ch, sh, co, si]
        psi = [p * sh, p * ch, -q * si, q * co]
        bent = [p * a * ch, p * a * sh, -q * b * co, -q * b * si]
        sheared = [(a - p) * sh, (a - p) * ch, -(b - q) * si, (b - q) * co]
        return {"clamped": [w, psi], "free": [bent, sheared], "supported": [w, bent]}[end]

    return np.linalg.det(np.array(rows(0.0, ends[0]) + rows(LENGTH, ends[1])))


LAST = 2 * MESH.stations.size - 2
ENDS = {
    ("clamped", "free"): [0, 1], ("supported", "supported"): [0, LAST], ("free", "free"): [],
    ("clamped", "clamped"): [0, 1, LAST, LAST + 1],
}  # fmt: skip


@pytest.mark.parametrize("ends", ENDS, ids="-".join)
def test_frequencies_solve_the_exact_equation(ends):
    natural = frequencies(MESH.mass, MESH.stiffness, ENDS[ends])[:4]
    for omega in natural[natural < HIGHEST]:
        exact = brentq(determinant, omega * (1 - 3e-5), omega * (1 + 3e-5), args=(ends,), xtol=1e-9 * omega)
        assert -1e-10 < omega / exact - 1 < 1e-6
    assert natural[1] < HIGHEST


def test_statics_is_exact_and_steps_are_where_they_are():
    # Two sections, clamped at z = 0, a force at the end: sum of bending and shear of both.
    thick = Piece(0.05, 0.05, 0.0, 206e9, 0.3, 7850.0)
    thin = Piece(0.03, 0.03, 0.01, 206e9, 0.3, 7850.0)
    mesh = beam([thick, thin], [], HIGHEST, 0.4)
    end = 2 * mesh.stations.size - 2
    force = np.zeros(mesh.mass.shape[0])
    force[end] = 1.0
    deflection = np.linalg.solve(mesh.stiffness[2:, 2:], force[2:])[end - 2]
    bent = ((0.08**3 - 0.03**3) / (thick.youngs_modulus * thick.second_moment)) / 3
    bent += 0.03**3 / (3 * thin.youngs_modulus * thin.second_moment)
    assert deflection == pytest.approx(
        bent + 0.05 / thick.shear_rigidity + 0.03 / thin.shear_rigidity, rel=1e-10
    )
    # Cowper 1966, table 1: solid circle 6 (1 + nu)/(7 + 6 nu), and a thin tube 2 (1 + nu)/(4 + 3 nu).
    assert thick.shear_rigidity / (thick.shear_modulus * thick.area) == pytest.approx(7.8 / 8.8, rel=1e-14)
    tube = Piece(1.0, 1.0, 1.0 - 1e-9, 1.0, 0.3, 1.0)
    assert tube.shear_rigidity / (tube.shear_modulus * tube.area) == pytest.approx(2.6 / 4.9, rel=1e-8)
    # Mass and rotary inertia of the whole as of a rigid body.
    rigid = np.zeros(mesh.mass.shape[0])
    rigid[: end + 2 : 2] = mesh.stations
    rigid[1 : end + 2 : 2] = 1.0
    masses = [piece.density * piece.area * piece.length for piece in (thick, thin)]
    about = sum(
        m * (place**2 + piece.length**2 / 12 + (piece.diameter**2 + piece.bore**2) / 16)
        for m, place, piece in zip(masses, (0.025, 0.065), (thick, thin), strict=True)
    )
    assert rigid @ mesh.mass @ rigid == pytest.approx(about, rel=1e-12)
    polar = sum(m * (p.diameter**2 + p.bore**2) / 8 for m, p in zip(masses, (thick, thin), strict=True))
    assert rigid @ mesh.spin @ rigid == pytest.approx(polar, rel=1e-12)


def test_twist():
    free = frequencies(MESH.twist_mass, MESH.twist_stiffness, [])[:4]
    exact = np.arange(1, 5) * math.pi / LENGTH * math.sqrt(HOLLOW.shear_modulus / HOLLOW.density)
    np.testing.assert_allclose(free, exact, rtol=1e-6)


def shaft(**more):
    """A nearly massless rod between bearings, the gear in the middle."""
    ball = {"loa_stiffness": 1e13, "oloa_stiffness": 1e13}
    ends = [{"position": 0} | ball, {"position": 200} | ball]
    table = {"segments": [{"length": 200, "diameter": 20}], "gear_position": 100, "bearings": ends}
    return Shaft.model_validate(table | {"density": 10} | more)


def test_torsion_of_two_and_three_inertias():
    rod = shaft()
    disc = Disc(1.0, 0.01, 0.005)
    piece = Piece(0.1, 0.02, 0.0, 206e9, 0.3, 10.0)
    spring = piece.shear_modulus * 2 * piece.second_moment / piece.length
    motor = CoupledInertia.model_validate({"position": 0, "inertia": 0.02, "coupling_stiffness": 1e4})
    _, _, torsion = supported_shaft(rod, disc, motor, 1e4).planes
    series = 1 / (1 / spring + 1 / 1e4)
    assert torsion.frequencies[0] == 0.0
    assert torsion.frequencies[1] == pytest.approx(math.sqrt(series * (1 / 0.01 + 1 / 0.02)), rel=1e-4)
    # The gear's body as a third inertia would have it: rim behind a spring, here with no inertia of the bore.
    _, _, soft = supported_shaft(rod, Disc(1.0, 0.01, 0.005, 2e4), motor, 1e4).planes
    series = 1 / (1 / series + 1 / 2e4)
    assert soft.frequencies[1] == pytest.approx(math.sqrt(series * (1 / 0.01 + 1 / 0.02)), rel=1e-4)
    heavy = shaft(density=7850)
    inertia = 7850 * 2 * piece.second_moment * 0.2
    _, _, heavy_torsion = supported_shaft(heavy, disc, motor, 1e4).planes
    assert 1 / heavy_torsion.shapes[0, 0] ** 2 == pytest.approx(0.03 + inertia, rel=1e-9)


def test_a_disc_whirls_at_the_frequencies_of_the_closed_form():
    # In the middle of a light rod the disc tilts by itself: Id w^2 - Jp Omega w - k = 0.
    rod = shaft()
    disc = Disc(1.0, 0.01, 0.006)
    omega = 3000.0
    rotor = supported_shaft(rod, disc, None, 3e4)
    x, y = (modes.frequencies for modes in rotor.planes[:2])
    n = x.size
    stiffness = np.diag(np.append(x, y) ** 2)
    gyroscopic = np.zeros((2 * n, 2 * n))
    gyroscopic[:n, n:] = omega * rotor.spin
    gyroscopic[n:, :n] = -omega * rotor.spin.T
    state = np.block([[np.zeros((2 * n, 2 * n)), np.eye(2 * n)], [-stiffness, -gyroscopic]])
    values, vectors = np.linalg.eig(state)
    spring = 12 * 206e9 * math.pi * 0.02**4 / 64 / 0.2
    piece = Piece(0.2, 0.02, 0.0, 206e9, 0.3, 10.0)
    spring /= 1 + 12 * 206e9 * piece.second_moment / (piece.shear_rigidity * 0.2**2)
    root = math.sqrt((0.01 * omega) ** 2 + 4 * 0.006 * spring)
    slope = rotor.planes[0].shapes[rotor.gear[0] + 1]
    for sense, speed in ((1, (0.01 * omega + root) / 0.012), (-1, (root - 0.01 * omega) / 0.012)):
        nearest = np.argmin(np.abs(values - 1j * speed))
        assert values[nearest].imag == pytest.approx(speed, rel=1e-3)
        # Forward is the sense of rotation, counter-clockwise: y follows x by a quarter turn.
        x_slope = slope @ vectors[:n, nearest]
        y_slope = slope @ vectors[n : 2 * n, nearest]
        assert y_slope / x_slope == pytest.approx(-1j * sense, abs=1e-6)

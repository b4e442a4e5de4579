"""Have the beams the frequencies and deflections of the closed forms, and does a disc whirl as it should?"""

import math

import numpy as np
import pytest
from scipy.linalg import eigh, expm

from lumped.schema.shafts import CoupledInertia, Shaft, ShaftBearing, ShaftSegment
from multibody.shafts.beam import Interval, bending, torsion
from multibody.shafts.train import Disc, reduced_shaft

#: A step, a bore and unlike lengths.
STEPPED = (
    Interval(0.11, 0.040, 0.0, 206e9, 0.3, 7850.0),
    Interval(0.07, 0.030, 0.012, 206e9, 0.3, 7850.0),
    Interval(0.13, 0.030, 0.012, 206e9, 0.3, 7850.0),
)


def cowper(part):
    """Cowper 1966, hollow circle, as he prints it, m the bore over the diameter."""
    nu, m = part.poisson_ratio, part.bore / part.diameter
    top = 6 * (1 + nu) * (1 + m**2) ** 2
    return top / ((7 + 6 * nu) * (1 + m**2) ** 2 + (20 + 12 * nu) * m**2)


def transfer(parts, omega):
    """Exact transfer matrix of (w, psi, M, Q) over Timoshenko beams at a frequency."""
    whole = np.eye(4)
    for part in parts:
        area = math.pi / 4 * (part.diameter**2 - part.bore**2)
        moment = math.pi / 64 * (part.diameter**4 - part.bore**4)
        shear = cowper(part) * part.youngs_modulus / 2 / (1 + part.poisson_ratio) * area
        rates = np.zeros((4, 4))
        rates[0, 1], rates[0, 3] = 1.0, 1.0 / shear  # w' = psi + Q/(kappa G A)
        rates[1, 2] = 1.0 / part.youngs_modulus / moment  # psi' = M/(E I)
        rates[2, 1], rates[2, 3] = -part.density * moment * omega**2, -1.0  # M' = -Q - rho I omega^2 psi
        rates[3, 0] = -part.density * area * omega**2  # Q' = -rho A omega^2 w
        whole = expm(rates * part.length) @ whole
    return whole


@pytest.mark.parametrize(
    ("start", "end", "rigid"),
    [((0, 1), (2, 3), 0), ((0, 2), (0, 2), 0), ((2, 3), (2, 3), 2)],
    ids=["cantilever", "simply supported", "free"],
)
def test_bending_frequencies_are_those_of_timoshenko(start, end, rigid):
    """The exact determinant changes its sign within 1e-9 of each of the first five frequencies."""
    beam = bending(STEPPED, 14)
    at = {0: 0, 1: beam.rotation}
    held = [at[i] for i in start if i in at] + [at[i] + len(STEPPED) for i in end if i in at]
    kept = np.setdiff1d(np.arange(len(beam.mass)), held)
    both = np.ix_(kept, kept)
    squares = eigh(beam.stiffness[both], beam.mass[both], eigvals_only=True)
    assert np.all(np.abs(squares[:rigid]) < 1e-9 * squares[rigid])
    free = [i for i in range(4) if i not in start]

    def determinant(omega):
        return np.linalg.det(transfer(STEPPED, omega)[np.ix_(end, free)])

    for omega in np.sqrt(squares[rigid : rigid + 5]):
        assert determinant(omega * (1 - 1e-9)) * determinant(omega * (1 + 1e-9)) < 0


def test_twist_frequencies_of_inertias_on_an_elastic_shaft():
    """A disc on the end and an inertia behind a coupling on the other: tan equations by transfer matrices."""
    shaft = Shaft.model_construct(
        segments=tuple(
            ShaftSegment.model_construct(length=p.length, diameter=p.diameter, bore=p.bore) for p in STEPPED
        ),
        gear_position=0.0,
        bearings=(bearing(0.0, 1e8), bearing(0.31, 1e8)),
        youngs_modulus=206e9,
        poisson_ratio=0.3,
        density=7850.0,
    )
    motor = CoupledInertia.model_construct(
        position=0.31, inertia=2e-3, coupling_stiffness=4e4, coupling_damping=0.0
    )
    disc = Disc(0.6, 3e-4, 2e-4, twist_stiffness=9e5)
    found = reduced_shaft(shaft, disc, motor, speed=0.0, damping_ratio=0.0, highest=1e6)
    twist = np.r_[2, [i for i in range(found.size) if found.torque[i] != 0.0 and i != 2]]
    both = np.ix_(twist, twist)
    squares = eigh(found.stiffness[both], found.mass[both], eigvals_only=True)

    def torque_left(omega):
        angle, torque = 1.0, -disc.inertia * omega**2  # of the rim, at its shaft side
        angle += torque / disc.twist_stiffness
        for part in STEPPED:
            polar = math.pi / 32 * (part.diameter**4 - part.bore**4)
            shear = part.youngs_modulus / 2 / (1 + part.poisson_ratio)
            wave = omega * math.sqrt(part.density / shear)
            c, s = math.cos(wave * part.length), math.sin(wave * part.length)
            angle, torque = (
                c * angle + s * torque / (shear * polar * wave),
                c * torque - s * angle * shear * polar * wave,
            )
        angle += torque / motor.coupling_stiffness
        return torque - motor.inertia * omega**2 * angle

    assert found.error < 1e-6
    for omega in np.sqrt(squares[1:4]):  # the kept modes are those with the gear held: reduced to some 1e-7
        assert torque_left(omega * (1 - 1e-6)) * torque_left(omega * (1 + 1e-6)) < 0


def bearing(position, stiffness, damping=0.0):
    return ShaftBearing.model_construct(
        position=position, loa_stiffness=stiffness, oloa_stiffness=stiffness, loa_damping=damping,
        oloa_damping=damping, tilt_stiffness=0.0,
    )  # fmt: skip


def symmetric(density, **changes):
    """A gear in the middle of 200 mm between two bearings."""
    fields = {
        "segments": (ShaftSegment.model_construct(length=0.2, diameter=0.03, bore=0.0),),
        "gear_position": 0.1, "bearings": (bearing(0.0, 3e8, 20.0), bearing(0.2, 3e8, 20.0)),
        "youngs_modulus": 206e9, "poisson_ratio": 0.3, "density": density,
    }  # fmt: skip
    return Shaft.model_construct(**(fields | changes))


def test_deflection_whirl_and_damping_of_a_disc_on_a_light_shaft():
    """F L^3/48 E I with shear and bearings; the tilting disc J_d w^2 -+ J_p Omega w = k; dashpots and ratio.

    Forward whirl, in the sense of rotation, is the faster one: counter-clockwise where Omega is positive.
    """
    disc, length, omega = Disc(0.8, 1.3e-3, 0.9e-3), 0.2, 900.0
    light = symmetric(0.1)
    part = Interval(length, 0.03, 0.0, 206e9, 0.3, 0.1)
    rigidity = part.youngs_modulus * part.second_moment
    soft = length**3 / 48 / rigidity + length / (4 * cowper(part) * part.shear_modulus * part.area)
    stiffness = 1.0 / (soft + 1 / 6e8)
    # Half a turning moment at the end of each half of the beam; shear and bearings give way under M/L.
    tilt = 1.0 / (length / 12 / rigidity + (1 / (cowper(part) * part.shear_modulus * part.area)) / length
                  + 2 / 3e8 / length**2)  # fmt: skip
    for speed in (omega, -omega):
        shaft = reduced_shaft(light, disc, None, speed=speed, damping_ratio=0.0, highest=3e4)
        assert shaft.stiffness[0, 0] == pytest.approx(stiffness, rel=1e-9)
        n, inverse = shaft.size, np.linalg.inv(shaft.mass)
        gyroscopic = 0.5 * (shaft.damping - shaft.damping.T)
        state = np.block([[np.zeros((n, n)), np.eye(n)], [-inverse @ shaft.stiffness, -inverse @ gyroscopic]])
        roots, vectors = np.linalg.eig(state)
        exact = [
            (side * disc.inertia * omega + math.sqrt((disc.inertia * omega) ** 2 + 4 * disc.tilting * tilt))
            / (2 * disc.tilting)
            for side in (-1, 1)
        ]
        for frequency, sense in zip(exact, (-1, 1), strict=True):
            one = int(np.abs(roots - 1j * frequency).argmin())
            assert roots[one].imag == pytest.approx(frequency, rel=1e-5)  # the shaft weighs 2e-5 of the disc
            x, y = (row @ vectors[:n, one] for row in shaft.bearings[0])
            turns = np.abs(x + 1j * y) - np.abs(x - 1j * y)  # > 0: counter-clockwise
            assert turns * sense * speed > 0.0
    damped = reduced_shaft(light, disc, None, speed=0.0, damping_ratio=0.03, highest=3e4)
    share = stiffness / 6e8  # how far the bearings move with the gear
    expected = 2 * 0.03 * math.sqrt(stiffness * disc.mass) + 40.0 * share**2
    assert damped.damping[0, 0] == pytest.approx(expected, rel=1e-5)
    assert damped.bearings[0, 0, 0] == pytest.approx(share, rel=1e-9)


def test_a_light_inertia_does_not_stall():
    """On a coupling it would swing at 1e9 Hz; it turns with its station, where a heavy one swings itself."""
    light, heavy = (
        CoupledInertia.model_construct(
            position=0.2, inertia=inertia, coupling_stiffness=1e6, coupling_damping=0.0
        )
        for inertia in (1e-12, 1e-3)
    )
    disc = Disc(0.8, 1.3e-3, 0.9e-3)
    options = {"speed": 0.0, "damping_ratio": 0.0, "highest": 1e5}
    one, two = (reduced_shaft(symmetric(7850.0), disc, motor, **options) for motor in (light, heavy))
    alone = reduced_shaft(symmetric(7850.0), disc, None, **options)
    assert one.mass[2, 2] == pytest.approx(alone.mass[2, 2] + 1e-12, rel=1e-12)
    assert two.mass[2, 2] == pytest.approx(alone.mass[2, 2] + 1e-3, rel=1e-9)
    assert one.torque[2] == pytest.approx(1.0, rel=1e-9)
    assert two.size == alone.size + 1 == one.size + 1


def test_mass_of_a_shaft():
    """A unit translation and a unit turn weigh what the shaft weighs."""
    beam, (mass, _) = bending(STEPPED, 5), torsion(STEPPED, 5)
    ones, turn = np.zeros(len(beam.mass)), np.zeros(len(mass))
    ones[: len(STEPPED) + 1], turn[: len(STEPPED) + 1] = 1.0, 1.0
    weight = sum(p.density * math.pi / 4 * (p.diameter**2 - p.bore**2) * p.length for p in STEPPED)
    inertia = sum(p.density * math.pi / 32 * (p.diameter**4 - p.bore**4) * p.length for p in STEPPED)
    assert ones @ beam.mass @ ones == pytest.approx(weight, rel=1e-13)
    assert turn @ mass @ turn == pytest.approx(inertia, rel=1e-13)

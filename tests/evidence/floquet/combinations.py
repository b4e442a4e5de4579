"""Combination resonances against first-order theory: Hsu's system and the gear chains of Lin and Parker."""

from collections.abc import Iterator

import numpy as np
from scipy.linalg import expm
from scipy.optimize import minimize_scalar

from floquet import monodromy
from tests.evidence.check import Check, order
from tests.evidence.floquet.reference_systems import GearChain, HsuSystem, tongue_ends

_OMEGA = np.array([1.0, 2.3])
_SYMMETRIC = np.array([[0.3, 0.8], [0.5, 0.4]])
_SKEW = np.array([[0.3, 0.8], [-0.5, 0.4]])


def _hsu_orders(system: HsuSystem, i: int, j: int, sign: int) -> tuple[float, float]:
    """Orders in epsilon of the errors of centre and width of a tongue; damping goes with epsilon."""
    errors = []
    for epsilon in (0.1, 0.05):
        one = HsuSystem(system.omega, system.coupling, system.damping * epsilon)
        predicted = one.boundaries(i, j, sign, epsilon)
        assert predicted is not None  # the cases below all have tongues
        lower, upper = np.subtract(tongue_ends(one, predicted, epsilon), predicted)
        errors.append((abs(lower + upper), abs(upper - lower)))
    centre, width = np.log2(np.array(errors[0]) / np.array(errors[1]))
    return float(centre), float(width)


def check_hsu() -> Iterator[Check]:
    """Ends of sum and difference tongues against first-order theory, and where there is none."""
    still, damped = np.zeros(2), np.array([4e-3, 1.6e-2])
    cases = (
        ("sum, symmetric", _SYMMETRIC, still, 0, 1, 1),
        ("difference, skew", _SKEW, still, 0, 1, -1),
        ("sum, unequal damping", _SYMMETRIC, damped, 0, 1, 1),
        ("difference, unequal damping", _SKEW, damped, 0, 1, -1),
        ("twice one mode", _SYMMETRIC, still, 0, 0, 1),
    )
    for name, coupling, damping, i, j, sign in cases:
        centre, width = _hsu_orders(HsuSystem(_OMEGA, coupling, damping), i, j, sign)
        yield order(f"Hsu, {name}: centre", centre, 2.0, 0.1)
        yield order(f"Hsu, {name}: width", width, 3.0, 0.3)
    worst = 0.0
    for coupling, sign in ((_SYMMETRIC, -1), (_SKEW, 1)):
        system = HsuSystem(_OMEGA, coupling - np.diag(np.diag(coupling)), still)
        centre = _OMEGA[1] + sign * _OMEGA[0]
        for excitation in centre + np.linspace(-0.06, 0.06, 25):
            worst = max(worst, monodromy(system.at(excitation, 0.1), 1e-11).spectral_radius - 1.0)
    yield Check("Hsu, the other combination", "no growth: theory has no tongue there", worst, 1e-5)


def _chain(contact_ratio: float) -> GearChain:
    """Idler chain of three gears."""
    return GearChain(
        mass=np.array([1.0, 1.6, 1.2]), ground=np.diag([0.4, 0.0, 0.15]),
        meshes=np.array([[1.0, -1.0, 0.0], [0.0, 1.0, -1.0]]), stiffness=np.array([2.0, 3.0]),
        contact_ratio=np.full(2, contact_ratio), phase=np.array([0.0, 0.3]),
    )  # fmt: skip


def check_gear_chain() -> Iterator[Check]:
    """Tongues of two meshes with rectangular waves, and the contact ratio that removes one."""
    system = _chain(1.4)
    for i, j, harmonic in ((2, 2, 1), (1, 2, 1), (1, 2, 2), (0, 2, 1)):
        errors = []
        for epsilon in (0.08, 0.04):
            predicted = system.boundaries(i, j, harmonic, epsilon)
            computed = tongue_ends(system, predicted, epsilon)
            errors.append(np.abs(np.subtract(computed, predicted)).max())
        name = f"gear chain, (w{i + 1}+w{j + 1})/{harmonic}: ends"
        yield order(name, np.log2(errors[0] / errors[1]), 2.0, 0.25)
    omega, _ = system.modes()
    for sigma, expected in ((1.4, 1.0), (1.5, 2.0)):
        growth = []
        for epsilon in (0.04, 0.02):
            middle, one = 0.5 * (omega[1] + omega[2]), _chain(sigma)

            def fall(x: float, one: GearChain = one, epsilon: float = epsilon) -> float:
                return -monodromy(one.at(x, epsilon), 1e-11).spectral_radius

            def fall_by_pieces(x: float, one: GearChain = one, epsilon: float = epsilon) -> float:
                system = one.at(x, epsilon)
                lengths, flow = np.diff(system.edges), np.eye(system.dimension)
                for A, length in zip(
                    system.evaluate(system.edges[:-1] + 0.5 * lengths), lengths, strict=True
                ):
                    flow = expm(length * A) @ flow
                return -float(np.abs(np.linalg.eigvals(flow)).max())

            # Exponentials of the pieces of constant stiffness find the place; the engine tells the growth.
            near = min(middle * (1.0 + np.linspace(-0.005, 0.005, 81)), key=fall_by_pieces)
            ends = near - 1.25e-4 * middle, near + 1.25e-4 * middle
            growth.append(-minimize_scalar(fall, bounds=ends, options={"xatol": 1e-6}).fun - 1.0)
        name = f"gear chain, growth in (w2+w3)/2, contact ratio {sigma}"
        yield order(name, np.log2(growth[0] / growth[1]), expected, 0.2)

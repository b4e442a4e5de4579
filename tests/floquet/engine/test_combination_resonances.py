"""Do combination tongues lie where first-order theory puts them, and only there?"""

from __future__ import annotations

import numpy as np
import pytest

from floquet import monodromy
from floquet.engine.reference_systems import GearChain, HsuSystem, tongue_ends

OMEGA = np.array([1.0, 2.3])
D = np.array([[0.3, 0.8], [0.5, 0.4]])  # d_12 d_21 > 0: like a symmetric coupling
SKEW = np.array([[0.3, 0.8], [-0.5, 0.4]])


def observed_orders(system: HsuSystem, i: int, j: int, sign: int) -> tuple[float, float]:
    """Orders in epsilon of the errors of the tongue's centre and of its width; damping goes with epsilon."""
    errors = []
    for epsilon in (0.1, 0.05):
        one = HsuSystem(system.omega, system.coupling, system.damping * epsilon)
        predicted = one.boundaries(i, j, sign, epsilon)
        assert predicted is not None
        lower, upper = np.subtract(tongue_ends(one, predicted, epsilon), predicted)
        errors.append((abs(lower + upper), abs(upper - lower)))
    centre, width = np.log2(np.divide(*errors))
    return float(centre), float(width)


# The expansion of an end in epsilon changes sign of its odd terms from one end to the other. So the centre
# misses the term of epsilon^2 and, first-order theory being right, the width that of epsilon^3.
ORDERS = (pytest.approx(2.0, abs=0.1), pytest.approx(3.0, abs=0.3))  # next powers at epsilon = 0.1


@pytest.mark.parametrize(
    ("coupling", "i", "j", "sign"), [(D, 0, 0, 1), (D, 1, 1, 1), (D, 0, 1, 1), (SKEW, 0, 1, -1)]
)
def test_hsu_boundaries_are_right_to_first_order(coupling: np.ndarray, i: int, j: int, sign: int) -> None:
    assert observed_orders(HsuSystem(OMEGA, coupling, np.zeros(2)), i, j, sign) == ORDERS


@pytest.mark.parametrize(("coupling", "sign"), [(D, 1), (SKEW, -1)])
def test_hsu_boundaries_with_unequal_damping(coupling: np.ndarray, sign: int) -> None:
    # Four times as much damping in one mode as in the other: it widens the tongue.
    damping = np.array([4e-3, 1.6e-2])
    wide = HsuSystem(OMEGA, coupling, 0.1 * damping).boundaries(0, 1, sign, 0.1)
    narrow = HsuSystem(OMEGA, coupling, np.zeros(2)).boundaries(0, 1, sign, 0.1)
    assert wide[1] - wide[0] > 1.1 * (narrow[1] - narrow[0])
    assert observed_orders(HsuSystem(OMEGA, coupling, damping), 0, 1, sign) == ORDERS


@pytest.mark.parametrize(("coupling", "sign"), [(D, -1), (SKEW, 1)])
def test_the_other_combination_is_stable(coupling: np.ndarray, sign: int) -> None:
    off = coupling - np.diag(np.diag(coupling))
    system = HsuSystem(OMEGA, off, np.zeros(2))
    assert system.boundaries(0, 1, sign, 0.1) is None
    centre = OMEGA[1] + sign * OMEGA[0]
    half = 0.05 * np.sqrt(0.8 * 0.5 / 2.3)  # half width that the opposite sign would have
    for excitation in np.linspace(centre - 3 * half, centre + 3 * half, 25):
        # 1e-5: multipliers meet on the unit circle, where rtol 1e-11 leaves its square root.
        assert monodromy(system.at(excitation, 0.1), 1e-11).spectral_radius < 1 + 1e-5


def test_damping_above_the_threshold_leaves_no_tongue() -> None:
    # G = c_1 c_2 closes it; 20 % above nothing is unstable, 20 % below something is (first order: epsilon).
    epsilon = 0.05
    c = epsilon * np.sqrt(0.4 / 2.3) / 4
    for factor, expected in ((0.8, True), (1.2, False)):
        system = HsuSystem(OMEGA, D, np.full(2, factor * c))
        assert (system.boundaries(0, 1, 1, epsilon) is not None) == expected
        excitations = np.linspace(3.28, 3.32, 41)
        radius = max(monodromy(system.at(x, epsilon), 1e-10).spectral_radius for x in excitations)
        assert (radius > 1.0) == expected


def chain(contact_ratio: float = 1.4, phase: float = 0.3) -> GearChain:
    """Idler chain: three gears, two meshes of one frequency, input and output held by shafts."""
    return GearChain(
        mass=np.array([1.0, 1.6, 1.2]),
        ground=np.diag([0.4, 0.0, 0.15]),
        meshes=np.array([[1.0, -1.0, 0.0], [0.0, 1.0, -1.0]]),
        stiffness=np.array([2.0, 3.0]),
        contact_ratio=np.array([contact_ratio, contact_ratio]),
        phase=np.array([0.0, phase]),
    )


@pytest.mark.parametrize(("i", "j", "harmonic"), [(2, 2, 1), (1, 2, 1), (1, 1, 2), (1, 2, 2), (0, 2, 1)])
def test_gear_chain_boundaries_are_right_to_first_order(i: int, j: int, harmonic: int) -> None:
    system = chain()
    errors = []
    for epsilon in (0.08, 0.04):
        predicted = system.boundaries(i, j, harmonic, epsilon)
        computed = tongue_ends(system, predicted, epsilon)
        errors.append(np.abs(np.subtract(computed, predicted)).max())
        assert errors[-1] < 0.25 * (predicted[1] - predicted[0])
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.25)  # next power of epsilon


def test_contact_ratio_and_phasing_close_tongues() -> None:
    # Rules of Lin and Parker: l (sigma - 1) whole removes harmonic l; and phasing can make two meshes cancel.
    system = chain(contact_ratio=1.5)
    assert system.coupling(1, 2, 2) < 1e-15 * 5
    omega, _ = system.modes()
    for sigma, order in ((1.5, 2.0), (1.4, 1.0)):
        one = chain(contact_ratio=sigma)
        growth = []
        for epsilon in (0.04, 0.02):
            excitations = 0.5 * (omega[1] + omega[2]) * (1 + np.linspace(-0.005, 0.005, 161))
            growth.append(max(monodromy(one.at(x, epsilon), 1e-11).spectral_radius for x in excitations) - 1)
        # Growth in proportion to epsilon where the harmonic is there, to its square where it is not. 0.2:
        # next power, and the grid of excitations.
        assert np.log2(growth[0] / growth[1]) == pytest.approx(order, abs=0.2)
    couplings = [chain(phase=p).coupling(1, 2, 1) for p in np.linspace(0, 1, 41)]
    deflection = chain().meshes @ chain().modes()[1]
    # Extremes are |A1| + |A2| and ||A1| - |A2||, the amplitudes of the meshes in phase and in opposition.
    parts = (
        2 / np.pi * np.sin(0.4 * np.pi) * np.array([2.0, 3.0]) * np.abs(deflection[:, 1] * deflection[:, 2])
    )
    assert max(couplings) == pytest.approx(parts.sum(), rel=1e-12)
    assert min(couplings) == pytest.approx(abs(parts[0] - parts[1]), rel=1e-12)

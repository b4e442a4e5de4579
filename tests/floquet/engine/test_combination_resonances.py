"""What does first-order theory of combination tongues say, beyond the ends that the verification checks?"""

import numpy as np
import pytest

from floquet import monodromy
from tests.evidence.floquet.reference_systems import GearChain, HsuSystem

OMEGA = np.array([1.0, 2.3])
D = np.array([[0.3, 0.8], [0.5, 0.4]])  # d_12 d_21 > 0: like a symmetric coupling
SKEW = np.array([[0.3, 0.8], [-0.5, 0.4]])


def test_unequal_damping_widens_a_tongue() -> None:
    # Four times as much damping in one mode as in the other.
    damped = 0.1 * np.array([4e-3, 1.6e-2])
    for coupling, sign in ((D, 1), (SKEW, -1)):
        wide, narrow = (
            HsuSystem(OMEGA, coupling, c).boundaries(0, 1, sign, 0.1) for c in (damped, 0 * damped)
        )
        assert wide[1] - wide[0] > 1.1 * (narrow[1] - narrow[0])


def test_theory_knows_no_tongue_of_the_other_combination() -> None:
    for coupling, sign in ((D, -1), (SKEW, 1)):
        assert HsuSystem(OMEGA, coupling, np.zeros(2)).boundaries(0, 1, sign, 0.1) is None


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


def test_contact_ratio_and_phasing_close_tongues() -> None:
    # Rules of Lin and Parker: l (sigma - 1) whole removes harmonic l; and phasing can make two meshes cancel.
    assert chain(contact_ratio=1.5).coupling(1, 2, 2) < 1e-15 * 5
    couplings = [chain(phase=p).coupling(1, 2, 1) for p in np.linspace(0, 1, 41)]
    deflection = chain().meshes @ chain().modes()[1]
    # Extremes are |A1| + |A2| and ||A1| - |A2||, the amplitudes of the meshes in phase and in opposition.
    parts = (
        2 / np.pi * np.sin(0.4 * np.pi) * np.array([2.0, 3.0]) * np.abs(deflection[:, 1] * deflection[:, 2])
    )
    assert max(couplings) == pytest.approx(parts.sum(), rel=1e-12)
    assert min(couplings) == pytest.approx(abs(parts[0] - parts[1]), rel=1e-12)

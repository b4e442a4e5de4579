"""Are tongues named by the motion that grows, and closed at the damping that closes them?"""

import numpy as np
import pytest

from floquet import monodromy, stability_margins
from floquet.engine.tongues import Tongue, label_tongue, mode_shares, tongue_tip
from tests.evidence.floquet.reference_systems import HsuSystem
from tests.unlike_pairs import unlike_pair


def coupled(omega: np.ndarray, coupling: np.ndarray, excitation: float):
    """Monodromy matrix of Hsu's system of strength 1 without damping, in (omega eta, eta')."""
    system = HsuSystem(omega, coupling, np.zeros_like(omega)).at(excitation, 1.0)
    scale = np.concatenate([omega, np.ones_like(omega)])
    M = monodromy(system, 1e-11).matrix
    return M * scale[:, None] / scale[None, :]


OMEGA = np.array([1.0, 2.3, 7.9])


@pytest.mark.parametrize(
    ("i", "j", "sign"), [(1, 1, 1), (3, 3, 1), (1, 2, 1), (1, 3, 1), (2, 3, 1), (1, 2, -1), (1, 3, -1)]
)
def test_each_resonance_is_named(i: int, j: int, sign: int) -> None:
    coupling = np.zeros((3, 3))
    # a difference needs a skew coupling
    coupling[i - 1, j - 1] = 0.08
    coupling[j - 1, i - 1] = 0.08 * sign
    excitation = OMEGA[j - 1] + sign * OMEGA[i - 1]
    M = coupled(OMEGA, coupling, excitation)
    assert np.abs(np.linalg.eigvals(M)).max() > 1 + 1e-3
    assert label_tongue(M, OMEGA, excitation) == Tongue(i, j, sign, 1)
    if i != j:
        values, vectors = np.linalg.eig(M)
        shares = mode_shares(vectors[:, np.argmax(np.abs(values))], OMEGA)
        # Manley and Rowe: equal action, though the energies are in the ratio of the frequencies. Terms off
        # resonance add a few percent at this strength.
        assert shares.sum(axis=0)[[i - 1, j - 1]] == pytest.approx(0.5, abs=0.03)
        forward = shares[0] > 0.25
        same_way = forward[i - 1] == forward[j - 1]
        assert same_way == (sign < 0)


def test_shape_decides_where_two_lines_cross() -> None:
    # 2 omega_1 = omega_2 - omega_3' by construction: 2.0 is both 2 w1 and w2 - w1 with omega = (1, 3). The
    # frequencies cannot tell; the coupling, and with it the motion, can.
    omega = np.array([1.0, 3.0])
    diagonal_block = np.zeros((2, 2))
    skew = np.zeros((2, 2))
    diagonal_block[0, 0] = 0.1
    skew[0, 1] = 0.2
    skew[1, 0] = -0.2
    assert label_tongue(coupled(omega, diagonal_block, 2.0), omega, 2.0) == Tongue(1, 1, 1, 1)
    assert label_tongue(coupled(omega, skew, 2.0), omega, 2.0) == Tongue(1, 2, -1, 1)


def test_shares_of_a_pure_rotation() -> None:
    # eta = exp(i w t): (omega eta, eta') = omega (1, i); of one mode only.
    state = np.array([0.0, 2.3, 0.0, 0.0, 2.3j, 0.0])
    shares = mode_shares(state, OMEGA)
    assert shares.tolist() == [[0, 1, 0], [0, 0, 0]]
    assert mode_shares(state.conj(), OMEGA)[1].tolist() == [0, 1, 0]


@pytest.fixture(scope="module")
def pair():
    """43 teeth drive 22, without friction and with light damping: several kinds of tongues."""
    changes = {f"bearings.{g}.loa_damping_ratio": 0.01 for g in ("pinion", "gear")}
    changes |= {"mesh.contact": "prescribed", "mesh.damping_ratio": 0.004, "friction.law": "none"}
    return unlike_pair("larger_gear_drives_contact_lost").with_(changes)


@pytest.fixture(scope="module")
def tongues(pair):
    return stability_margins(pair, (9500.0, 17500.0)).tongues


def test_labels_of_the_gear_pair(tongues) -> None:
    labels = {tongue.label for tongue in tongues}
    # On unlike bearings each mode moves the mesh.
    assert {"(w1+w3)/2", "(w2+w3)/2", "2w3/3", "2w3/2"} <= labels


@pytest.mark.parametrize("share", [0.0, 0.03, 0.31, 0.5, 0.69, 0.97, 1.0])
def test_a_tongue_closes_at_the_top_of_its_peak_on_either_side_of_a_sample(share):
    """1 + tip - damping - (x - peak)^2 has its top at the peak, and closes where the damping is the tip.

    The window is sampled in 32 steps, and the peak is at a share of the step behind the tenth one.
    """
    low, high, tip = 0.7, 2.3, 0.04
    peak = low + (10.0 + share) / 32.0 * (high - low)
    found = tongue_tip(lambda x, damping: 1.0 + tip - damping - (x - peak) ** 2, (low, high), (0.0, 0.1))
    # Four rounds of a factor of 16 leave a step of 0.05/16^3, the width of which is squared: 1.5e-10.
    assert found.damping == pytest.approx(tip, abs=1e-9)
    assert found.place == pytest.approx(peak, abs=0.05 / 16**3)


@pytest.mark.parametrize("peak", [0.7, 2.3])
def test_a_tongue_that_rises_to_an_end_of_its_window_closes_there(peak):
    found = tongue_tip(lambda x, damping: 1.04 - damping - abs(x - peak), (0.7, 2.3), (0.0, 0.1))
    assert found.place == peak
    assert found.damping == pytest.approx(0.04, abs=1e-9)

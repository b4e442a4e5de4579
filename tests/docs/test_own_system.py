"""Are the systems of the tutorial on any system those of its words, by closed forms?"""

import re

import numpy as np
import pytest

from floquet import from_second_order, monodromy, sampled_matrix, scan


@pytest.fixture(scope="module")
def blade(root, blocks):
    """The function of the page."""
    (source,) = (
        b.text for b in blocks(root / "docs/tutorial/own_system.md") if b.text.startswith("# blade.py")
    )
    names: dict[str, object] = {}
    exec(compile(source, "blade.py", "exec"), names)
    return names["blade"]


@pytest.mark.parametrize(("lock_number", "frequency"), [(8.0, 1.0), (5.0, 1.15), (12.0, 1.08)])
def test_the_blade_in_hover_is_an_oscillator(blade, lock_number, frequency):
    """beta'' + gamma/8 beta' + nu^2 beta = 0: exponents -gamma/16 +- i sqrt(nu^2 - (gamma/16)^2)."""
    exponents = monodromy(blade(0.0, lock_number, frequency)).exponents
    decay = lock_number / 16.0
    turns = np.sqrt(frequency**2 - decay**2)
    assert exponents.real == pytest.approx([-decay, -decay], rel=1e-10)
    lowest = abs(turns - round(turns))  # the principal branch
    assert np.abs(exponents.imag) == pytest.approx([lowest, lowest], abs=1e-9)


def test_the_coefficients_are_the_moment_of_the_lift(blade):
    """gamma/2 times the integral over r of r u_T u_P, u_T = r + mu sin, u_P = r beta' + mu beta cos."""
    mu, gamma = 0.37, 9.0
    r, weight = np.polynomial.legendre.leggauss(6)
    r, weight = 0.5 * (r + 1.0), 0.5 * weight
    system = blade(mu, gamma)
    for psi in (0.4, 2.2, 4.9):
        along = r + mu * np.sin(psi)
        damping = 0.5 * gamma * (weight * r * along * r).sum()
        stiffness = 1.0 + 0.5 * gamma * (weight * r * along * mu * np.cos(psi)).sum()
        # The coordinates of one degree of freedom are scaled, its characteristic polynomial is not.
        A = system.evaluate([psi])[0]
        assert (-np.trace(A), np.linalg.det(A)) == pytest.approx((damping, stiffness), rel=1e-12)


def test_the_blade_loses_stability_at_the_root_of_two(blade):
    """Small Lock number: half the excitation gamma mu^2/8 at 2 nu is the damping gamma/8 (Hsu 1963)."""
    chart = scan(lambda at: blade(**at), {"advance_ratio": [1.39, 1.44], "lock_number": [0.1, 0.3]})
    assert chart["verdict"].to_numpy().tolist() == [[1, 1], [-1, -1]]


def test_an_open_crack_is_a_rotor_of_unequal_stiffness(root):
    """A crack that never closes, without damping: unstable between the frequencies of both directions."""
    page = (root / "docs/tutorial/own_system.md").read_text("utf-8")
    assert re.search(r"opening = 0\.5 \* \(1 \+ np\.cos\(angle\)\)", page)
    loss = 0.3
    for speed, unstable in ((0.80, False), (0.85, True), (0.98, True), (1.03, False)):
        turn = 2.0 * np.pi / speed
        times = np.linspace(0.0, turn, 181)
        angle = 2.0 * np.pi * times / turn
        crack = np.stack([np.cos(angle), np.sin(angle)], axis=1)
        K = np.eye(2) - loss * crack[:, :, None] * crack[:, None, :]
        table = sampled_matrix(times, K, between="cubic")
        radius = monodromy(from_second_order(np.eye(2), np.zeros((2, 2)), table, turn)).spectral_radius
        assert (np.sqrt(1.0 - loss) < speed < 1.0) == unstable == (radius > 1.0 + 1e-4)

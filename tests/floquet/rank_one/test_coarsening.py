"""Do fewer pieces with the same moments give the same flow, within the bound, and does the bound bite?"""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from floquet import RankOneSystem, fast_monodromies, gear_block
from floquet.rank_one.coarsening import coarsened
from floquet.rank_one.system import Gains
from lumped import load_gear_pair
from lumped.errors import ParameterError

LAWS = ["benedict_kelley", "xu_kahraman", "smoothed_coulomb", "composite"]


def staircase(rng: np.random.Generator, pieces: int, degree: int = 0, m: int = 2) -> RankOneSystem:
    """Random polynomials on many pieces, with jumps between all of them: nothing that could be fitted."""
    v, metric = rng.normal(size=m), rng.uniform(0.5, 2.0, m)
    w = 0.3 * rng.normal(size=(pieces, m, degree + 1))
    w[:, :, 0] += rng.uniform(0.5, 2.0) * v / metric

    def gains(w: np.ndarray, wd: np.ndarray) -> Gains:
        return Gains(w, wd, np.zeros((pieces, 2)))

    return RankOneSystem(
        stiffness=np.diag(rng.uniform(0.5, 4.0, m)),
        damping=np.diag(rng.uniform(0.0, 0.1, m)),
        v=v,
        phases=np.concatenate([[0.0], np.sort(rng.uniform(0.01, 0.99, pieces - 1)), [1.0]]),
        gains=gains(w, 0.05 * rng.normal(size=(pieces, m, 2))),
        period=1.0,
        metric=metric,
        varied=(gains(0.2 * rng.normal(size=(pieces, m, 1)), 0.01 * rng.normal(size=(pieces, m, 1))),),
    )


def difference(
    system: RankOneSystem, coarse: RankOneSystem, T: float, zeta: float, g: float
) -> tuple[float, float]:
    """2-norm of the difference of the matrices, and its bound."""
    one = fast_monodromies(system, [T], zeta, g)
    other = fast_monodromies(coarse, [T], zeta, g)
    # Both have the same mean gains, so the same energy coordinates but for rounding and signs of the modes.
    S, R = system.modal().state_matrix(), coarse.modal().state_matrix()
    P = np.linalg.solve(S, R)
    moved = P @ other.matrices[0] @ np.linalg.inv(P)
    return float(np.linalg.norm(moved - one.matrices[0], 2)), float(other.errors[0] + one.errors[0])


@pytest.mark.parametrize("tolerance", [0.3, 1e-2, 1e-4])
def test_bound_holds_where_nothing_can_be_fitted(tolerance: float) -> None:
    seed = 31
    rng = np.random.default_rng(seed)
    joined = 0
    for _ in range(60):
        system = staircase(rng, int(rng.integers(4, 40)), int(rng.integers(0, 4)))
        longest = float(10.0 ** rng.uniform(-1.5, 0.8))
        coarse = coarsened(system, longest, 1.5, [1.2], tolerance)
        joined += int(coarse.phases.size < system.phases.size)
        T, zeta, g = longest * rng.uniform(0.3, 1.0), rng.uniform(0, 1.5), rng.uniform(-1.2, 1.2)
        found, bound = difference(system, coarse, T, zeta, g)
        assert found <= bound, (seed, longest, T, zeta, g)
    assert joined > 30


@pytest.mark.parametrize("degree", [0, 1, 2])
def test_bound_is_near_the_first_order_change(degree: int) -> None:
    # One oscillator, w = 1 + 0.3 P_degree(u) + e P_(degree + 1)(u) in two pieces. Joined to that degree,
    # e P_(degree + 1) is missing; the flow changes by e int P_(degree + 1) K du to first order, which is more
    # than the terms of second order, so that a bound of theirs alone would fail.
    e, T = 1e-4, 2.0
    whole = np.zeros(degree + 2)
    whole[0], whole[degree], whole[degree + 1] = 1.0, 1.0 if degree == 0 else 0.3, e
    power = np.polynomial.Polynomial(np.polynomial.legendre.leg2poly(whole))
    halves = [power(np.polynomial.Polynomial([middle, 0.5])).coef for middle in (-0.5, 0.5)]
    w = np.zeros((2, 1, degree + 2))
    w[:, 0] = halves
    system = RankOneSystem(
        stiffness=np.array([[0.2]]),
        damping=np.array([[0.0]]),
        v=np.array([1.0]),
        phases=np.array([0.0, 0.5, 1.0]),
        gains=Gains(w, np.zeros((2, 1, 1)), np.zeros((2, 2))),
        period=T,
        metric=np.array([1.0]),
    )
    coarse = coarsened(system, T, 1.0, [], 30 * e)
    assert coarse.gains.w.shape == (1, 1, degree + 1)
    found, bound = difference(system, coarse, T, 1.0, 1.0)
    assert found <= bound
    assert found > bound / 1000.0  # 1000: norms of K over the ellipse, and Frobenius norms
    assert found > 10.0 * e**2


def test_moments_are_kept() -> None:
    system = gear_block(load_gear_pair("nasa_28_28").with_(friction__law="benedict_kelley"), rtol=1e-9)
    coarse = coarsened(system, system.period, 1.0, [], 1e-9)
    assert coarse.phases.size < 0.7 * system.phases.size
    assert set(coarse.phases) <= set(system.phases)
    x, weight = np.polynomial.legendre.leggauss(12)
    for low, high in pairwise(coarse.phases):
        inside = [p for p in system.phases if low <= p <= high]
        for n in (0, 1, 2):
            moments = []
            for block, edges in ((system, inside), (coarse, [low, high])):
                total = np.zeros(3)
                for a, b in pairwise(edges):
                    piece = int(np.searchsorted(block.phases, 0.5 * (a + b))) - 1
                    at = 0.5 * (a + b) + 0.5 * (b - a) * x
                    u = (2.0 * at - low - high) / (high - low)
                    values = np.polynomial.polynomial.polyval(x, block.gains.w[piece].T)
                    total += 0.5 * (b - a) * (values * weight * u**n).sum(axis=1)
                moments.append(total)
            if coarse_degree(coarse, low) >= n:
                assert np.abs(moments[1] - moments[0]).max() <= 1e-12 * np.abs(system.gains.w).max()


def coarse_degree(system: RankOneSystem, low: float) -> int:
    used = np.abs(system.gains.w[int(np.flatnonzero(system.phases == low)[0])]).max(axis=0)
    return int(np.flatnonzero(used)[-1])


@pytest.mark.parametrize("law", LAWS)
def test_gear_blocks_within_their_bounds(law: str) -> None:
    rng = np.random.default_rng(8)
    pair = load_gear_pair("fzg_c").with_({"friction.law": law, "mesh.damping_ratio": 1.0})
    block = gear_block(pair, rtol=1e-10, friction_apart=True, friction_level=0.03)
    for longest in block.period * np.array([0.1, 0.4, 2.0]):
        coarse = coarsened(block, longest, 0.1, [1.3, 1.3], 5e-10)
        assert coarse.phases.size < block.phases.size
        for _ in range(3):
            factors = rng.uniform(0.5, 1.3, (1, 2))
            T, zeta = longest * rng.uniform(0.6, 1.0), float(rng.uniform(0.0, 0.1))
            one, other = (fast_monodromies(s, [T], zeta, factors) for s in (block, coarse))
            distance = np.linalg.norm(one.matrices[0] - other.matrices[0], 2)
            assert distance <= one.errors[0] + other.errors[0]


def test_short_periods_need_fewer_pieces() -> None:
    block = gear_block(load_gear_pair("nasa_28_28").with_(friction__law="xu_kahraman"), friction_apart=True)
    counts = [coarsened(block, block.period * f, 1.0, [1.0], 1e-9).phases.size for f in (2.0, 0.5, 0.1, 0.01)]
    assert counts == sorted(counts, reverse=True)
    assert counts[-1] < counts[0] / 3
    one_piece = coarsened(block, block.period * 1e-7, 1.0, [1.0], 1e-6)
    assert one_piece.phases.size == 2  # nothing moves within so short a period: the mean is enough
    assert one_piece.gains.w.shape[2] == 1


def test_variants_beyond_the_bound_are_refused() -> None:
    block = gear_block(load_gear_pair("nasa_28_28").with_(friction__law="xu_kahraman"), friction_apart=True)
    coarse = coarsened(block, block.period, 1.0, [1.0], 1e-8)
    fast_monodromies(coarse, [block.period], 1.0, 1.0)
    with pytest.raises(ParameterError, match="periods"):
        fast_monodromies(coarse, [1.01 * block.period])
    with pytest.raises(ParameterError, match="damping_factors"):
        fast_monodromies(coarse, [block.period], 1.01)
    with pytest.raises(ParameterError, match="gain_factors"):
        fast_monodromies(coarse, [block.period], 1.0, -1.01)


def test_errors_of_the_given_polynomials_are_passed_on() -> None:
    rng = np.random.default_rng(4)
    system = staircase(rng, 12)
    declared = np.full((12, 2), 1e-3)
    wrong = replace(system, gains=replace(system.gains, fit_errors=declared))
    plain, careful = (coarsened(s, 0.05, 1.0, [1.0], 0.1) for s in (system, wrong))
    assert plain.phases.size < 13
    added = fast_monodromies(careful, [0.05]).errors[0] - fast_monodromies(plain, [0.05]).errors[0]
    form = system.modal()
    first_order = 1e-3 * 0.05 * (np.linalg.norm(form.v / form.omega) + np.linalg.norm(form.v))
    assert added > 0.99 * first_order

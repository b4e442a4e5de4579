"""Is what is proven between the nodes of a chart true everywhere, and is much proven?"""

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import expm

from floquet import RankOneSystem, fast_multipliers
from floquet.gear.axes import GearVariation
from floquet.gear.multipliers import feedback_system, fitted_block
from floquet.rank_one import boxes
from floquet.rank_one.batch import fast_monodromies
from floquet.rank_one.boxes import (
    FlowPolynomial,
    GainDeviation,
    bounded_entries,
    decided,
    proven_cells,
    slow_period,
)
from floquet.rank_one.kernel_input import packed
from floquet.rank_one.system import Gains
from lumped import load_gear_pair
from tests.evidence.floquet.extended import state_matrix
from tests.evidence.floquet.reference_systems import mathieu_many, mathieu_system, meissner_trace

DEPTH = 0.5


def no_factors(T):
    return np.empty((T.size, 0))


def meissner():
    """z'' + 2 zeta z' + (1 +- depth) z = 0: z = exp(-zeta t) y, and y obeys Meissner's equation."""
    w = np.array([[[1.0 + DEPTH]], [[1.0 - DEPTH]]])
    wd = np.full((2, 1, 1), 2.0)
    system = RankOneSystem(
        np.zeros((1, 1)), np.zeros((1, 1)), np.ones(1), np.array([0.0, 0.5, 1.0]),
        Gains(w, wd, np.zeros((2, 2))), 1.0, np.ones(1),
    )  # fmt: skip

    def radius(T, zeta):
        half = 0.5 * np.abs([meissner_trace(1.0 - z**2, DEPTH, t) for t, z in zip(T, zeta, strict=True)])
        return np.exp(-zeta * T) * (half + np.sqrt(np.maximum(half**2 - 1.0, 0.0))).clip(min=1.0)

    return system, radius


def mathieu():
    """z'' + 2 zeta z' + (1 - 0.8 depth cos) z = 0, likewise."""

    def radius(T, zeta):
        values, _ = mathieu_many((1.0 - zeta**2) * (T / np.pi) ** 2, 0.4 * DEPTH * (T / np.pi) ** 2)
        return np.exp(-zeta * T) * np.abs(values).max(axis=1)

    return mathieu_system(0.4 * DEPTH, 2.0), radius


def inside(rng, edges, count):
    """Places in each interval, (count, cells); near its ends as often as elsewhere."""
    share = rng.beta(0.5, 0.5, (count, edges.size - 1))
    return edges[:-1] + share * np.diff(edges)


@pytest.mark.parametrize("case", [meissner, mathieu])
def test_proven_cells_are_those_of_the_closed_form(case) -> None:
    system, radius = case()
    T = np.linspace(1.5, 20.0, 201)
    zeta = np.linspace(0.002, 0.12, 61)
    verdict = proven_cells(system, T, zeta, no_factors)
    # 95 % and 98 % measured: edges pass through the others, or they lie at next to no damping.
    assert np.mean(verdict != 0) > 0.94
    assert min((verdict > 0).sum(), (verdict < 0).sum()) > 200
    rng = np.random.default_rng(1)
    for t, z in zip(inside(rng, T, 3), inside(rng, zeta, 3), strict=True):
        exact_radius = radius(np.repeat(t, z.size), np.tile(z, t.size)).reshape(verdict.shape)
        assert ((exact_radius < 1.0) == (verdict > 0))[verdict != 0].all()


def test_slow_variation_is_stable_from_the_period_of_the_closed_form() -> None:
    """Each period the ratio of the frequencies of both halves is gained at most, which the worst T does."""
    system, radius = meissner()
    gain = 0.5 * np.log((1.0 + DEPTH) / (1.0 - DEPTH))
    for zeta in (0.005, 0.02):
        T = slow_period(system, np.full(2, zeta), np.empty((2, 0)))
        assert abs(T * zeta / gain - 1.0) < 2e-3
        after = T * np.linspace(1.0, 1.2, 2000)
        assert radius(after, np.full(after.size, zeta)).max() < 1.0
    assert slow_period(system, np.array([0.005, 0.02]), np.empty((2, 0))) >= gain / 0.005
    # A gain that is 1 in the middle of every cell only looks constant.
    w = 1.5 * np.polynomial.polynomial.polyfromroots([-0.75, -0.25, 0.25, 0.75])
    w[0] += 1.0
    hidden = RankOneSystem(
        np.zeros((1, 1)), np.zeros((1, 1)), np.ones(1), np.array([0.0, 1.0]),
        Gains(w[None, None], np.full((1, 1, 1), 2.0), np.zeros((1, 2))), 1.0, np.ones(1),
    )  # fmt: skip
    T = np.linspace(2.0, 20.0, 400)
    unstable = T[np.abs(fast_multipliers(hidden, T, 0.005).multipliers).max(axis=1) > 1.0]
    assert unstable.max() < slow_period(hidden, np.full(2, 0.005), np.empty((2, 0)))


def test_bounds_of_the_polynomial_hold_where_it_is_bad() -> None:
    """Over far too wide a patch; of a constant system closely. The growth is that of flows within a cycle."""
    system, _ = meissner()
    one = np.ones((1, 1, 1))
    constant = replace(system, phases=np.array([0.0, 1.0]), gains=Gains(one, 0.0 * one, np.zeros((1, 2))))
    damping = np.array([0.0, 1.0])
    u = np.linspace(0.0, 1.0, 101)
    for one_system, width, z, loose in ((system, 1e-3, u, np.inf), (constant, 24.0, 0.0 * u, 3e3)):
        patch = FlowPolynomial.of(
            one_system, packed(one_system), 60.0 + width * damping, damping * z[-1], no_factors
        )
        M = fast_monodromies(one_system, 60.0 + width * u, z).matrices
        x, y = (np.polynomial.chebyshev.chebvander(2.0 * v - 1.0, n - 1) for v, n in ((u, 24), (z, 16)))
        model = np.einsum("ka,abij,kb->kij", x, patch.coefficients, y)
        error = np.linalg.norm(M - model, 2, axis=(1, 2)).max()
        assert 1e-6 < error < patch.error < loose * error
    narrow = FlowPolynomial.of(system, packed(system), np.array([6.0, 6.001]), damping[[0, 0]], no_factors)
    turns = [
        expm(np.array([[0.0, 1.0], [-k, 0.0]]) * s)
        for k in (1.0 + DEPTH, 1.0 - DEPTH)
        for s in np.linspace(0.0, 3.0, 31)
    ]
    largest = max(np.linalg.norm(a @ b, 2) for a in turns[:31] for b in turns[31:])
    assert largest < narrow.growth < 1.8 * largest


@pytest.mark.parametrize("terms", [(8, 4), (3, 1)])
def test_bounds_hold_everywhere_in_boxes(terms, monkeypatch) -> None:
    """Bounds on the polynomial and on the moduli of its entries hold and are not loose; its error counts."""
    variation = GearVariation(load_gear_pair("nasa_art_25_31"), supports="springs")
    block = fitted_block(feedback_system(variation), 1.0, 1e-11, [0.0])

    def factors(T):
        return (T[:, None] / block.period) ** 0.1

    periods = block.period * np.array([0.35, 0.55])
    damping = np.array([0.01, 0.03])
    patch = FlowPolynomial.of(block, packed(block), periods, damping, factors)
    rng = np.random.default_rng(2)
    ends = np.sort(rng.uniform(-1.0, 1.0, (2, 2, 60)), axis=1)
    ends[:, 1, :50] = ends[:, 0, :50] + 0.1 * np.diff(ends, axis=1)[:, 0, :50]
    ends[:, :, 50:] = np.array([-1.0, 1.0])[:, None]  # the whole patch, where the series is cut off
    monkeypatch.setattr(boxes, "_TERMS", terms)
    assert decided(patch, *ends).verdict.any()
    assert not decided(replace(patch, error=1.0), *ends).verdict.any()
    V, low, high, f, _, _ = bounded_entries(replace(patch, error=0.0), *ends)
    places = (
        ends[:, 0, :, None]
        + np.diff(ends, axis=1)[:, 0, :, None]
        * np.array([[0.0, 0.0, 1.0, 1.0, 0.5], [0.0, 1.0, 0.0, 1.0, 0.5]])[:, None]
    )
    T, z = (v.mean() + 0.5 * np.diff(v) * x.ravel() for v, x in zip((periods, damping), places, strict=True))
    M = fast_monodromies(block, T, z, factors(T)).matrices
    x, y = (
        np.polynomial.chebyshev.chebvander(v.ravel(), n - 1) for v, n in zip(places, (24, 16), strict=True)
    )
    model = np.einsum("ka,abij,kb->kij", x, patch.coefficients, y)
    assert np.linalg.norm(M - model, 2, axis=(1, 2)).max() <= patch.error < 1e-2
    moduli = np.abs(np.linalg.inv(V)[:, None] @ model.reshape(60, 5, 6, 6) @ V[:, None])
    diagonal = np.einsum("kpii->kpi", moduli).copy()
    assert (diagonal <= high[:, None]).all()
    assert (diagonal >= low[:, None]).all()
    moduli[..., range(6), range(6)] = 0.0
    assert (moduli <= f[:, None]).all()
    if terms == (3, 1):  # then most is only bounded
        return
    assert (high - low)[:50].sum() < 1.5 * np.ptp(diagonal, axis=1)[:50].sum()
    assert f[:50].sum() < 1.2 * moduli.max(axis=1)[:50].sum()


def signed_system(
    signs: tuple[float, float] = (1.0, 1.0),
    turn: float = 0.0,
    mirror: float = 1.0,
    flip: float = 1.0,
    gyroscopic: bool = False,
) -> RankOneSystem:
    """Two coordinates and two varied gains of alternating signs; each gain is multiplied by a sign.

    The coordinates may be turned by an angle and mirrored, and v and all gains have the other sign: the same
    motion.
    """
    rng = np.random.default_rng(5)
    w, wd = 0.1 * rng.normal(size=(2, 3, 3, 2, 4)) * 0.2 ** np.arange(4)
    w[0, :, :, 0] += [2.0, -1.4]
    Q = np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]]) * [1.0, mirror]
    parts = [
        Gains(sign * Q @ w[q], sign * Q @ wd[q], *(1e-9 * np.abs(rng.normal(size=(n, 2))) for n in (3, 4)))
        for q, sign in enumerate((flip, *(flip * sign for sign in signs)))
    ]
    return RankOneSystem(
        stiffness=Q @ np.diag([3.0, 5.0]) @ Q.T, damping=Q @ np.diag([1.6, 1.4]) @ Q.T, period=1.0,
        v=flip * Q @ [1.0, -0.7], phases=np.array([0.0, 0.2, 0.7, 1.0]), gains=parts[0],
        varied=tuple(parts[1:]), metric=np.ones(2), mean=flip * Q @ [2.0, -1.4],
        gyroscopic=mirror * np.array([[0.0, 0.3], [-0.3, 0.0]]) if gyroscopic else None,
    )  # fmt: skip


def powers_of_the_period(signs):
    """Factors on both varied gains: one rises, one falls; each is multiplied by a sign."""
    return lambda T: np.array(signs) * [0.3, 0.5] * T[:, None] ** [0.7, -0.4]


def lines_in_its_logarithm(signs):
    """The same as of a law whose level is shifted."""
    return lambda T: np.array(signs) * np.stack([0.3 + 0.2 * np.log(T), 0.9 - 0.3 * np.log(T)], axis=1)


@pytest.mark.parametrize("law", [powers_of_the_period, lines_in_its_logarithm])
@pytest.mark.parametrize("gyroscopic", [False, True])
def test_bounds_belong_to_the_motion_not_to_how_its_signs_are_written(law, gyroscopic) -> None:
    """A gain and its factor with the other sign, v and all gains with it, other axes change no bound.

    Over so wide a patch that the error of its polynomial is not that of its nodes.
    """
    T = np.array([2.0, 6.0])
    zeta = np.array([0.5, 0.8])
    some = np.array([2.2, 2.4])

    def bounds(signs, damping=1.0, **written):
        system = signed_system(signs, gyroscopic=gyroscopic, **written)
        factors = law(signs)
        if damping < 0.0:
            parts = [replace(part, wd=-part.wd) for part in system.parts]
            system = replace(system, gains=parts[0], varied=tuple(parts[1:]))
            return fast_monodromies(system, some, -0.7, factors(some)).errors.tolist()
        patch = FlowPolynomial.of(system, packed(system), T, zeta, factors)
        slow = slow_period(system, zeta, factors(T))
        errors = fast_monodromies(system, some, 0.7, factors(some)).errors.tolist()
        return [*errors, patch.error, patch.growth, slow]

    plain = bounds((1.0, 1.0))
    assert np.isfinite(plain).all() or gyroscopic
    for signs in ((-1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)):
        assert bounds(signs) == pytest.approx(plain, rel=1e-12)
        # The roundings of other axes are bounded by the moduli there: some 1e-15 of all, 1e-5 of the least.
        for turn, mirror in ((0.4, 1.0), (1.9, -1.0), (3.0, -1.0)):
            assert bounds(signs, turn=turn, mirror=mirror, flip=-1.0) == pytest.approx(plain, rel=1e-5)
    assert bounds((1.0, -1.0), damping=-1.0) == pytest.approx(plain[:2], rel=1e-12)


def energy_rates(form, phases, phase, T, zeta, gains):
    """T A (2m, 2m) in energy coordinates at a phase, for complex T and zeta too."""
    i = np.searchsorted(phases, phase) - 1
    low, high = phases[i], phases[i + 1]
    u = (2.0 * phase - low - high) / (high - low)
    w, wd = (
        sum(g * poly[i] @ u ** np.arange(poly.shape[2]) for g, poly in zip(gains, polys, strict=True))
        for polys in (form.w, form.wd)
    )
    spring = np.diag(form.omega) + np.outer(w - form.reference, form.v / form.omega)
    damper = T * form.C + form.gyroscopic + T * zeta * np.outer(wd, form.v)
    return np.block([[np.zeros_like(spring), T * np.diag(form.omega)], [-T * spring, -damper]])


@pytest.mark.parametrize("law", [powers_of_the_period, lines_in_its_logarithm])
@pytest.mark.parametrize("signs", [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0)])
def test_the_change_of_factors_is_bounded_on_ellipses_of_the_period(law, signs) -> None:
    """Powers and logarithms of complex periods, on the boundary, where an analytic function is largest."""
    T = np.linspace(2.0, 2.6, 9)
    middle = 2.3
    factors = law(signs)
    values = factors(np.append(T, middle))
    bound = boxes._factor_change(np.append(T, middle) / middle, values)
    assert (bound[0] == 0.0).all()  # of the gains that have no factor
    inside = boxes._RADII < 14.0  # beyond, an ellipse reaches the period 0
    assert (bound[1:, boxes._RADII > 16.0] > 1e29).all()
    w = boxes._RADII[inside, None] * np.exp(2j * np.pi * np.arange(64) / 64)
    change = factors((middle + 0.15 * (w + 1.0 / w)).ravel()) - values[-1]
    largest = np.abs(change).reshape(*w.shape, 2).max(axis=1).T
    assert (largest <= bound[1:, inside]).all()
    # Of both laws the larger bound counts: a line is taken as a power too, from its end of least modulus on.
    assert (bound[1:, inside] < 3.0 * largest)[:, boxes._RADII[inside] < 4.0].all()


def test_factors_of_no_law_prove_nothing() -> None:
    """Neither a power of the period nor a line in its logarithm: above the line, and below it."""
    system = signed_system()
    problem = packed(signed_system())
    T = np.array([2.0, 2.5])
    zeta = np.array([0.5, 0.8])
    for bend in (0.01, -0.01):

        def bent(T, bend=bend):
            return 1.0 + np.stack([bend * np.log(T) ** 2, 0.1 * np.log(T)], axis=1)

        assert FlowPolynomial.of(system, problem, T, zeta, bent) is None
        assert not proven_cells(system, np.linspace(2.0, 2.5, 5), np.linspace(0.5, 0.8, 3), bent).any()


def change_over(system, factors, T, zeta):
    """Bounds on the change along both axes for all radii, and the change itself at a complex T and zeta.

    It is the integral of |T A - T_0 A_0|, by Gauss's formula at 12 points a piece.
    """
    middle = T.mean()
    values = factors(np.append(np.linspace(*T, 9), middle))
    factor_change = boxes._factor_change(np.append(np.linspace(*T, 9), middle) / middle, values)
    size = boxes.PatchSize(packed(system), 1.7, np.append(1.0, values[-1]))
    semi = 0.5 * (boxes._RADII + 1.0 / boxes._RADII)
    one = np.ones_like(boxes._RADII)
    along = size.change(T, zeta, semi, one, factor_change)
    up = size.change(T, zeta, one, semi, np.repeat(factor_change[:, :1], semi.size, axis=1))
    nodes, weights = np.polynomial.legendre.leggauss(12)
    low = system.phases[:-1, None]
    width = np.diff(system.phases)[:, None]
    phases = (low + 0.5 * width * (nodes + 1.0)).ravel()
    weights = (0.5 * width * weights).ravel()
    form = system.modal()

    def rates(T_, z, gains):
        return np.array([energy_rates(form, system.phases, p, T_, z, np.append(1.0, gains)) for p in phases])

    still = rates(middle, zeta.mean(), values[-1])

    def change(T_, z):
        # The law of the factors, continued: powers and logarithms of complex periods.
        changed_rates = rates(T_, z, factors(np.array([T_]))[0])
        return weights @ np.linalg.norm(changed_rates - still, 2, axis=(1, 2))

    return along, up, change


@pytest.mark.parametrize("law", [powers_of_the_period, lines_in_its_logarithm])
def test_the_change_over_a_patch_is_bounded_on_its_ellipses(law) -> None:
    T = np.array([2.0, 5.0])
    zeta = np.array([0.1, 1.1])
    along, up, change = change_over(signed_system((-1.0, 1.0)), law((-1.0, 1.0)), T, zeta)
    for k in (0, 4, 8):  # radii 1.5, 2.5, 4.1; beyond, the ellipse of the period reaches 0
        w = boxes._RADII[k] * np.exp(0.25j * np.pi * np.arange(8))
        ellipse = 0.5 * (w + 1.0 / w)
        lengths = [change(3.5 + 1.5 * s, z) for s in ellipse for z in zeta]
        heights = [change(t, 0.6 + 0.5 * s) for s in ellipse for t in T]
        # Norms of sums are bounded by sums of norms, of polynomials by those of their terms.
        assert 0.3 * along[k] < max(lengths) <= along[k]
        assert 0.3 * up[k] < max(heights) <= up[k]


@pytest.mark.parametrize("kind", ["w", "wd", "varied w", "varied wd"])
def test_the_change_over_a_patch_is_no_more_than_that_of_one_large_gain(kind) -> None:
    """Of one coordinate and one constant gain, 1e4 times all others, the bound is attained at a corner.

    A factor on it moves it as much where the period grows as where it shrinks, but for the 9 % by which this
    patch is wide.
    """
    one = np.ones((1, 1, 1))
    small = np.zeros((1, 2))
    gain = {name: 1e4 * one if name == kind else one for name in ("w", "wd", "varied w", "varied wd")}
    system = RankOneSystem(
        stiffness=np.ones((1, 1)), damping=np.ones((1, 1)), v=np.ones(1), phases=np.array([0.0, 1.0]),
        gains=Gains(gain["w"], gain["wd"], small),
        varied=(Gains(gain["varied w"], gain["varied wd"], small),), period=1.0,
        metric=np.ones(1), mean=np.ones(1),
    )  # fmt: skip
    T = np.array([3.4, 3.6]) if "varied" in kind else np.array([2.0, 5.0])
    zeta = np.array([0.1, 1.1])
    along, up, change = change_over(system, lambda T: T[:, None] ** 0.7, T, zeta)
    semi = 0.5 * (1.5 + 1.0 / 1.5)  # of the smallest ellipse, along the axis
    longest = change(3.5 + 0.5 * np.ptp(T) * semi, zeta[1])
    highest = change(T[1], 0.6 + 0.5 * semi)
    assert 0.91 * along[0] < longest <= along[0]
    assert 0.91 * up[0] < highest <= up[0]


def test_the_error_of_a_patch_is_that_of_the_theorem() -> None:
    """4 M r^-n/(r - 1) with M = kappa exp(kappa d), of the best of the ellipses along each axis.

    The second polynomial goes through values of the first, whose Lebesgue constant is 1 + 2/pi log 24.
    """
    system = signed_system()
    kappa = 1.7
    T = np.array([2.0, 6.0])
    zeta = np.array([0.1, 0.8])
    size = boxes.PatchSize(packed(system), kappa)
    total = 0.0
    for axis, (nodes, lebesgue) in enumerate(((24, 1.0), (16, 1.0 + 2.0 / np.pi * np.log(24)))):
        best = np.inf
        for r in boxes._RADII:
            reach = np.ones((2, 1))
            reach[axis] = 0.5 * (r + 1.0 / r)
            d = size.change(T, zeta, *reach, np.zeros((3, 1)))[0]
            best = min(best, kappa * d + np.log(4.0 * kappa / (r - 1.0)) + (1 - nodes) * np.log(r))
        total += lebesgue * np.exp(best)
    assert size.error(T, zeta) == pytest.approx(total, rel=1e-8, abs=0.0)


def test_gains_that_deviate_leave_cells_unproven() -> None:
    """The more they deviate the fewer cells are proven; no verdict changes its sign."""
    system, _ = meissner()
    T, zeta = np.linspace(7.0, 7.1, 5), np.linspace(0.02, 0.1, 9)
    exact = proven_cells(system, T, zeta, no_factors)
    counts = []
    for strength in (1e-6, 1e-3, 1e-2, 1.0):
        verdict = proven_cells(system, T, zeta, no_factors, deviation=GainDeviation(strength, 0.0))
        assert ((verdict == 0) | (verdict == exact)).all()
        counts.append(int((verdict != 0).sum()))
    assert counts[0] > 0.8 * (exact != 0).sum()
    assert counts == sorted(counts, reverse=True)
    assert counts[2] < counts[0]
    assert counts[-1] == 0
    long, high = np.linspace(200.0, 201.0, 3), np.array([0.3, 0.4])  # slow variation
    assert (proven_cells(system, long, high, no_factors) == 1).all()
    assert not proven_cells(system, long, high, no_factors, deviation=GainDeviation(10.0, 0.0)).any()


def test_the_slow_period_is_that_of_its_formula() -> None:
    """Sum ln|L' L^-1| over - sum mu share, of three constant frozen systems of two coordinates.

    Over intervals of damping and of a factor mu is the largest of those of the corners.
    """
    w = np.array([[2.2, -1.3], [1.9, -1.6], [2.4, -1.2]])[:, :, None]
    extra = np.array([[0.1, 0.05], [-0.1, 0.02], [0.03, -0.08]])[:, :, None]
    system = RankOneSystem(
        stiffness=np.diag([3.0, 5.0]), damping=np.diag([0.9, 0.7]), v=np.array([1.0, -0.7]), period=1.0,
        phases=np.array([0.0, 0.2, 0.7, 1.0]), gains=Gains(w, 0.3 * w, np.zeros((3, 2))),
        varied=(Gains(extra, 0.5 * extra, np.zeros((3, 2))),), metric=np.ones(2), mean=np.array([2.0, -1.4]),
    )  # fmt: skip
    form = system.modal()
    zeta = np.array([0.5, 0.8])
    factors = np.array([[-0.7], [1.1]])
    places = (system.phases[1:] + system.phases[:-1]) / 2

    def frozen(z, g):
        return [energy_rates(form, system.phases, p, 1.0, z, [1.0, g]) for p in places]

    V = [np.linalg.eig(A)[1] for A in frozen(zeta.mean(), factors.mean())]
    corners = [frozen(z, g) for z in zeta for g in factors.ravel()]
    rate = 0.0
    for k, share in enumerate(np.diff(system.phases)):
        transformed = [np.linalg.solve(V[k], A[k] @ V[k]) for A in corners]
        rate += share * max(np.linalg.eigvalsh(0.5 * (B + B.conj().T))[-1] for B in transformed)
    steps = sum(np.log(np.linalg.norm(np.linalg.solve(V[(k + 1) % 3], V[k]), 2)) for k in range(3))
    # The bound itself is raised by 1e-9 for its rounding.
    assert 1.0 <= slow_period(system, zeta, factors) / (steps / -rate) < 1.0 + 3e-9


def test_gains_stay_as_near_to_the_middles_of_their_cells_as_is_said() -> None:
    """Polynomials of alternating signs; of a line all that is said is attained."""
    rng = np.random.default_rng(9)
    poly = rng.normal(size=(2, 3, 2, 6)) * 0.7 ** np.arange(6)
    poly[1, :, :, 2:] = 0.0
    cells = np.array([-0.75, -0.25, 0.25, 0.75])
    value, spread = (x.reshape(2, 3, 4, 2) for x in boxes._around(poly, cells))
    places = cells[:, None] + 0.25 * np.linspace(-1.0, 1.0, 41)
    powers = places[..., None] ** np.arange(6)
    far = np.abs(np.einsum("qpmj,cuj->qpcmu", poly, powers) - value[..., None]).max(axis=-1)
    assert (far <= spread * (1.0 + 1e-12)).all()
    assert spread.sum() < 1.2 * far.sum()
    assert spread[1] == pytest.approx(far[1], rel=1e-12)


def test_errors_of_the_gains_make_slow_variation_slower() -> None:
    """With as much less damping as is declared, everywhere or in a pulse at a break, longer T are unstable.

    Meissner's equation of frequencies 5 and 3 times 17^-1/2: both halves turn by odd quarters at T = pi
    17^1/2, where the gain is ln(5/3), all that the bound allows for.
    """
    system, _ = meissner()
    w = np.array([25.0, 9.0])[:, None, None] / 17.0
    zeta = np.full(2, 0.0396)
    e = 0.05
    width = 1e-3
    gains = replace(system.gains, w=w)

    def slow(gains):
        return slow_period(replace(system, gains=gains), zeta, np.empty((2, 0)))

    def longest(gains, phases=system.phases):
        T = np.pi * np.sqrt(17.0) + np.linspace(-0.5, 1.0, 3000)
        multipliers = fast_multipliers(replace(system, gains=gains, phases=phases), T, zeta[0]).multipliers
        return T[np.abs(multipliers).max(axis=1) > 1.0].max()

    pulse = np.array([0.0, e / width, 0.0])[:, None, None]
    thinner = Gains(w[[0, 0, 1]], gains.wd[[0, 0, 1]] - pulse, np.zeros((3, 2)))
    edges = np.array([[0.0, 0.0], [0.0, e], [0.0, 0.0]])
    for bound, exact in (
        (slow(replace(gains, fit_errors=np.array([[0.0, e]] * 2))), longest(replace(gains, wd=gains.wd - e))),
        (slow(replace(gains, edge_errors=edges)), longest(thinner, np.array([0.0, 0.5 - width, 0.5, 1.0]))),
    ):
        assert slow(gains) * 1.0002 < exact <= bound
        # Damping acts on one of two states, so half of it counts; the condition of the frozen ones is 2 to 3,
        # and the tongue ends before the bound of its gain does.
        assert bound - slow(gains) < 16.0 * (exact - slow(gains))


def test_errors_of_the_nodes_are_in_that_of_the_polynomial() -> None:
    """All gains have exactly the declared error, so the polynomial has the error of its nodes."""
    system, _ = meissner()
    T = np.array([3.0, 3.2])
    zeta = np.array([0.01, 0.05])
    e = 1e-6
    declared = replace(system, gains=replace(system.gains, fit_errors=np.full((2, 2), e)))
    with_errors = replace(system, gains=replace(system.gains, w=system.gains.w + e, wd=system.gains.wd - e))
    patch = FlowPolynomial.of(declared, packed(declared), T, zeta, no_factors)
    middle = np.einsum("abij,a,b->ij", patch.coefficients, np.cos(np.pi / 2 * np.arange(24)),
                       np.cos(np.pi / 2 * np.arange(16)))  # fmt: skip
    S = np.linalg.solve(state_matrix(declared.modal()), state_matrix(with_errors.modal()))
    M = S @ fast_monodromies(with_errors, [3.1], 0.03).matrices[0] @ np.linalg.inv(S)
    distance = np.linalg.norm(M - middle, 2)
    # The constants of Lebesgue are 3.02^2, and the bound of a node is up to ten times its error.
    assert distance <= patch.error < 10.0 * 9.2 * distance
    hopeless = replace(system, gains=replace(system.gains, fit_errors=np.full((2, 2), 1.0)))
    assert FlowPolynomial.of(hopeless, packed(hopeless), T, zeta, no_factors).growth == np.inf

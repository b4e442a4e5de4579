"""Is the error of the polynomials of a friction law bounded, and hardly more than it is?

The laws are written once more, by interval arithmetic of 77 digits.
"""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

pytest.importorskip("flint", reason="needs python-flint (extra: test)")

from flint import arb, arb_poly, ctx

from lumped.friction import LAWS
from lumped.friction.base import FrictionLaw, fit_signed
from lumped.friction.misfit import Ellipses, entraining, fit_misfit
from lumped.path_function import PathFunction
from tests.unlike_pairs import unlike_pair

_T = np.cos(np.pi * (np.arange(300) + 0.5) / 300)


def sampled(function, law, path, settings):
    low, high = function.breaks[:-1, None], function.breaks[1:, None]
    xi = 0.5 * (low + high) + 0.5 * (high - low) * _T
    return np.abs(law.signed(xi.ravel(), path, settings).reshape(xi.shape) - function(xi)).max(axis=1)


def exact_errors(function, law, path, settings, side):
    """Largest error of each piece of a fit, rounded down, of the law and of the polynomials with 77 digits.

    A position is the exact sum of the start of a piece and of a share of its width.
    """
    arithmetic = SimpleNamespace(
        log10=lambda x: arb(x).log() / arb(10).log(), exp=lambda x: arb(x).exp(),
        sqrt=lambda x: arb(x).sqrt(), arctan=lambda x: arb(x).atan(),
    )  # fmt: skip
    ctx.prec = 256
    largest_errors = []
    for j, low in enumerate(function.breaks[:-1]):
        width = arb(function.breaks[j + 1]) - arb(low)
        fit = arb_poly(function.coefficients[::-1, j].tolist())
        errors = [
            abs(
                law_of(law, width * share + low, path, settings, side, arithmetic) - fit(width * share)
            ).lower()
            for share in map(arb, _PLACES)
        ]
        largest_errors.append(max(map(float, errors)) * (1.0 - 1e-15))
    return np.array(largest_errors)


@pytest.mark.parametrize("law", [name for name, law in LAWS.items() if law.analytic])
def test_the_bound_holds_everywhere_and_is_small_over_the_path(unlike, law):
    for speed in (500.0, 4000.0, 20000.0):
        pair = unlike.with_(operating__pinion_speed=speed)
        path = pair.nominal_contact
        settings = pair.friction
        record = LAWS[law]
        fit = fit_signed(record, path, settings)
        bound = fit_misfit(fit, record, path, settings)
        assert (sampled(fit, record, path, settings) <= bound).all()
        # The fit is wanted to 1e-10; next to P, where mu falls to 0 or is held, short pieces are known worse.
        assert bound @ np.diff(fit.breaks) < 1e-10 * (path.L_XD - path.L_XA)


#: Ends and middle of a piece, between the nodes of a fit where the first polynomial that it drops is largest,
#: and other places, as shares of its width.
_PLACES = np.unique([*(0.5 - 0.5 * np.cos(np.pi * np.arange(10) / 9)), 1e-9, 0.003, 0.31, 0.5, 0.82, 0.998])


@pytest.mark.parametrize("side", [-1.0, 1.0], ids=["approach", "recess"])
@pytest.mark.parametrize("law", ["benedict_kelley", "xu_kahraman", "smoothed_coulomb"])
def test_the_bound_of_a_coarse_fit_is_close_to_its_error(unlike, law, side):
    """Pieces that end near the pitch point, where laws are steep; law IV varies within 1/sharpness of it."""
    path = unlike.nominal_contact
    record = LAWS[law]
    reach = path.L_XD - path.L_XP if side > 0.0 else path.L_XP - path.L_XA
    pair = unlike.with_(friction__sharpness=0.02 / reach, friction__maximum=1.0)  # [1/mm]
    settings = pair.friction
    breaks = np.sort(path.L_XP + side * reach * np.geomspace(0.02, 0.9, 5))
    coarse = PathFunction.fit(lambda xi: record.signed(xi, path, settings), breaks, tolerance=1e-3)
    bound = fit_misfit(coarse, record, path, settings)
    error = exact_errors(coarse, law, path, settings, side)
    assert error.max() > 1e-10
    # The sum of the moduli of Chebyshev coefficients is hardly more than the value at an end, where the first
    # one that is left out is largest and the next ones add up. Law III has a rough bound in its ellipse.
    assert (error <= bound).all()
    assert (bound < 1.5 * error).all()


def law_with(signed, analytic):
    """A law of no gear: its value at positions, and what bounds it in ellipses."""
    return FrictionLaw(
        "made up", "made up", lambda xi, path, settings: signed(xi), lambda *_: [], analytic=analytic
    )


@pytest.mark.parametrize("steep", [10, 40])
def test_an_error_at_the_ends_of_a_piece_is_all_of_its_bound(steep):
    """mu = x^steep, x from -1 to 1 over a piece, less nothing: half of it is within 1/steep of the ends.

    All its Chebyshev coefficients are positive, so that their sum is 1, its value at the end.
    """
    half = 0.002
    centre = 0.0305
    law = law_with(
        lambda xi: ((xi - centre) / half) ** steep,
        lambda low, high, path, settings: (np.full(1, 2.5), np.full(1, 1.45**steep)),  # (2.5 + 1/2.5)/2
    )
    path = unlike_pair("rack_25_degrees_always_pushing").nominal_contact
    nothing = PathFunction(np.array([centre - half, centre + half]), np.zeros((1, 1)), np.empty(0))
    (bound,) = fit_misfit(nothing, law, path, None)
    assert 1.0 <= bound < 1.0001


def test_an_error_between_the_nodes_of_a_fit_is_all_of_its_bound():
    """T_9 is 0 at the nodes of a fit of degree 8, and 1 between them and at the ends."""
    breaks = np.array([0.0285, 0.0325])
    size = 1e-4
    law = law_with(
        lambda xi: size * chebyshev_of(9, xi, breaks),
        lambda low, high, path, settings: (np.full(1, 2.5), np.full(1, size * 2.5**9)),
    )
    path = unlike_pair("rack_25_degrees_always_pushing").nominal_contact
    fit = PathFunction.fit(lambda xi: law.signed(xi, path, None), breaks, tolerance=1.01 * size)
    assert fit.breaks.size == 2
    assert np.abs(fit(np.linspace(*breaks, 50)[:-1])).max() < 1e-12 * size
    (bound,) = fit_misfit(fit, law, path, None)
    assert size <= bound < 1.0001 * size


def chebyshev_of(degree, xi, ends):
    """T_n over a piece."""
    x = np.clip((2.0 * xi - ends[0] - ends[1]) / (ends[1] - ends[0]), -1.0, 1.0)
    return np.cos(degree * np.arccos(x))


@pytest.mark.parametrize("ratio", [1.12, 1.2])
def test_what_65_nodes_do_not_see_is_bounded_by_the_ellipse(ratio):
    """T_65 is 0 at all of them, and (r^65 + r^-65)/2 at most in the ellipse: the bound is 2 r/(r - 1)."""
    breaks = np.array([0.0285, 0.0325])
    law = law_with(
        lambda xi: chebyshev_of(65, xi, breaks),
        lambda low, high, path, settings: (np.full(1, ratio), np.full(1, 0.5 * (ratio**65 + ratio**-65))),
    )
    path = unlike_pair("rack_25_degrees_always_pushing").nominal_contact
    nothing = PathFunction(breaks, np.zeros((1, 1)), np.empty(0))
    (bound,) = fit_misfit(nothing, law, path, None)
    # More by what rounding of the position may do with a slope of this modulus over the distance.
    assert bound == pytest.approx(2.0 * ratio / (ratio - 1.0), rel=1e-5)


def test_a_piece_at_a_singular_point_is_bounded_by_both_moduli():
    law = law_with(
        lambda xi: np.full(xi.shape, 0.01), lambda low, high, path, settings: (np.ones(1), np.full(1, 0.01))
    )
    fit = PathFunction(np.array([0.0285, 0.0325]), np.array([[-2.0], [0.005]]), np.empty(0))
    path = unlike_pair("rack_25_degrees_always_pushing").nominal_contact
    assert fit_misfit(fit, law, path, None) == pytest.approx(0.01 + 0.005 + 2.0 * 0.004)


def test_ellipses_come_half_as_near_as_their_piece():
    """Sampled on their boundary: to a real point exactly half as near, to a complex one at most half."""
    low, high = np.array([1.0, -0.3]), np.array([2.0, 0.1])
    w = np.exp(2j * np.pi * np.arange(20000) / 20000)
    assert Ellipses.clear_of(low, high, [2.0]).ratio[0] == 1.0
    for point in (2.05, 0.8, 3.0, 0.6 + 0.02j, 2.2 + 0.3j, 1.5 + 0.1j, -0.1 + 0.01j):
        around = Ellipses.clear_of(low, high, [point])
        for k, r in enumerate(around.ratio):
            boundary = 0.5 * (low[k] + high[k]) + 0.25 * (high[k] - low[k]) * (r * w + 1.0 / (r * w))
            distance = np.abs(boundary - point)
            piece = abs(np.clip(np.real(point), low[k], high[k]) - point)
            assert distance.min() >= 0.5 * piece * (1.0 - 1e-6)
            if np.imag(point) == 0.0 and 1.0 < r < 2.5:
                assert distance.min() == pytest.approx(0.5 * piece, rel=1e-6)
            nearest, farthest = (x[k] for x in around.distances(complex(point)))
            assert nearest <= distance.min() * (1.0 + 1e-12)
            assert farthest >= distance.max() * (1.0 - 1e-12)
            assert around.reach[k] == pytest.approx(np.abs(boundary - around.centre[k]).max(), rel=1e-12)


@pytest.mark.parametrize("side", [-1.0, 1.0], ids=["approach", "recess"])
@pytest.mark.parametrize("law", ["benedict_kelley", "xu_kahraman", "smoothed_coulomb"])
def test_the_law_is_at_most_its_bound_in_the_ellipse(unlike, law, side):
    """By the law written for complex positions, on the boundary, where an analytic function is largest.

    Also of thick oil under high load, where the exponential of law III falls with its shear. The bound counts
    4 times 2.3^-64 = 3e-23 of it: it may be rough, so that a term of it more or less is not always seen here.
    """
    settings = unlike.friction
    record = LAWS[law]
    for path in (unlike.nominal_contact, replace(unlike.nominal_contact, viscosity=0.5, unit_load=2e6)):
        reach = path.L_XD - path.L_XP if side > 0.0 else path.L_XP - path.L_XA
        ends = np.sort(path.L_XP + side * reach * np.geomspace(0.02, 0.9, 8))
        ratio, most = record.analytic(ends[:-1], ends[1:], path, settings)
        around = Ellipses(0.5 * (ends[:-1] + ends[1:]), 0.5 * np.diff(ends), ratio)
        w = ratio[:, None] * np.exp(2j * np.pi * np.arange(100) / 100)
        z = around.centre[:, None] + 0.5 * around.half[:, None] * (w + 1.0 / w)
        limited = np.abs(law_of(law, around.centre, path, settings, side)) > settings.maximum
        inside = np.abs(law_of(law, z, path, settings, side)).max(axis=1) <= most
        assert (inside | (limited & (law == "benedict_kelley"))).all()
        slow, fast = entraining(around, path)
        speed = path.omega_pinion * z + path.omega_gear * (path.L_XY - z)
        assert (np.abs(speed).max(axis=1) <= fast * (1.0 + 1e-12)).all()
        assert (np.abs(speed).min(axis=1) >= slow * (1.0 - 1e-12)).all()


def law_of(law, z, path, settings, side=1.0, functions=np):
    """A law without its bounds on one side of the pitch point, at complex places or in other arithmetic."""
    d = side * (z - path.L_XP)
    v_e = path.omega_pinion * z + path.omega_gear * (path.L_XY - z)
    v_s = (path.omega_pinion + path.omega_gear) * d
    S = path.roughness * 1e6
    if law == "benedict_kelley":
        number = 29.7 * path.unit_load / (path.viscosity * 1e3 * v_s * v_e**2)
        return side * 0.0127 * 1.13 / (1.13 - S) * functions.log10(number)
    if law == "smoothed_coulomb":
        x = settings.sharpness * d
        mean = 2.0 / np.pi * LAWS["coulomb"].factor(path, settings)
        return side * mean * (functions.arctan(x) + x / (1.0 + x**2))
    b1, b2, b3, b4, b5, b6, b7, b8, b9 = (
        -8.916465, 1.03303, 1.036077, -0.354068, 2.812084, -0.100601, 0.752755, -0.390958, 0.620305
    )  # fmt: skip
    radius = z * (path.L_XY - z) / path.L_XY
    eta = path.viscosity * 1e3
    p_h = 1e-9 * functions.sqrt(path.unit_load * path.effective_modulus / (2.0 * np.pi * radius))
    slide = 2.0 * v_s / v_e
    shear = slide * p_h * np.log10(eta)
    f = b1 + b4 * shear + b5 * functions.exp(-shear) + b9 * np.exp(S)
    return side * functions.exp(f) * p_h**b2 * slide**b3 * (0.5 * v_e) ** b6 * eta**b7 * radius**b8

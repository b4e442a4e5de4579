"""Is the loss factor the integral it stands for, and is it the published number?"""

import itertools
import math

import numpy as np
import pytest
from scipy.integrate import quad

from lumped import geometry, load_gear_pair, preset_names
from lumped.errors import ParameterError
from lumped.losses import addendum_contact_ratios, loss_factor, ohlendorf, ohlendorf_of
from lumped.path_of_contact import pair_stiffness

#: Pairs with contact ratios below 2, for which closed forms are known.
UP_TO_TWO_PAIRS = [name for name in preset_names() if load_gear_pair(name).geometry.contact_ratio < 2.0]


@pytest.mark.parametrize("name", UP_TO_TWO_PAIRS)
def test_closed_form_is_the_integral(name):
    # Derived in ohlendorf's docstring; both are exact, so only rounding may differ.
    pair = load_gear_pair(name)
    assert loss_factor(pair) == pytest.approx(ohlendorf_of(pair), rel=1e-13)


@pytest.mark.parametrize(
    ("name", "published", "last_place"),
    [
        # GEARpie's report of the FZG C14 gears prints H_V (Ohlendorf) = 0.1986
        ("fzg_c", 0.1986, 5e-5),
        # 28/28, 20 deg, standard addendum: eps_1 = eps_2 = 1.6380/2, so
        # H_v = pi 2/28 (1 - 1.6380 + 1.6380^2/2) = 0.15787; 5e-5 in 1.6380 moves it by 7e-6
        ("nasa_28_28", 0.15787, 1e-5),
    ],
)
def test_loss_factor_of_known_pairs(name, published, last_place):
    assert loss_factor(load_gear_pair(name)) == pytest.approx(published, abs=last_place)


def test_equal_halves_recover_the_textbook_form():
    # eps_1 = eps_2 = 1/2: one pair at a time, mean |s| = 1/4, H_v = 2 pi (u+1)/(z u) / 4
    assert ohlendorf(20, 40, 0.5, 0.5) == pytest.approx(2 * math.pi * 3 / 40 / 4, rel=1e-15)


def test_single_tooth_pair_at_a_time_costs_more_than_two():
    # Sharing the load where sliding is fastest pays: a longer path at half load against single contact only
    assert ohlendorf(20, 40, 0.8, 0.8) > ohlendorf(20, 40, 0.5, 0.5)


def brute_force(pair, relative=lambda xi: 1.0):
    """H_v from its definition by adaptive quadrature over the cycle, pair by pair."""
    g = geometry(pair)

    def integrand(phase):
        positions = [g.L_XA + j * g.base_pitch + phase for j in range(g.pairs)]
        positions = [xi for xi in positions if xi <= g.L_XD]
        total = sum(relative(xi) for xi in positions)
        slide = [(g.omega_pinion + g.omega_gear) * abs(xi - g.L_XP) for xi in positions]
        return sum(relative(xi) / total * v for xi, v in zip(positions, slide, strict=True))

    marks = sorted({(x - g.L_XA) % g.base_pitch for x in (g.L_XP, g.L_XD)})
    edges = [0.0, *marks, g.base_pitch]
    whole = sum(quad(integrand, a, b, epsrel=1e-12)[0] for a, b in itertools.pairwise(edges))
    return whole / g.base_pitch / (g.omega_pinion * g.base_radius_pinion)


@pytest.fixture(scope="module")
def high_contact_ratio():
    # A tall tooth: contact ratio above 2, where the closed form does not apply
    pair = load_gear_pair("kahraman_blankenship_50_50").with_(
        pinion__addendum=4.2,
        gear__addendum=4.2,
        basic_rack__dedendum_coefficient=1.6,
        basic_rack__fillet_radius_coefficient=0.2,
    )
    assert geometry(pair).contact_ratio > 2.0
    return pair


def test_contact_ratio_above_two(high_contact_ratio):
    # exact against adaptive quadrature at 1e-12
    assert loss_factor(high_contact_ratio) == pytest.approx(brute_force(high_contact_ratio), rel=1e-10)
    assert abs(ohlendorf_of(high_contact_ratio) / loss_factor(high_contact_ratio) - 1) > 0.05


def test_sharing_by_stiffness():
    pair = load_gear_pair("fzg_c")
    g = geometry(pair)
    # 1 + 2 t (1 - t) over the path, t = 0 at A and 1 at D: stiffest in the middle
    points = list(np.linspace(0.0, g.contact_ratio, 201))
    t = np.array(points) / g.contact_ratio
    table = {
        "model": "table",
        "axis": "phase",
        "points": points,
        "stiffness": list(1e8 * (1 + 2 * t * (1 - t))),
    }
    pair = pair.with_(mesh__stiffness=table)
    curve = pair_stiffness(pair)
    expected = brute_force(pair, lambda xi: float(curve(min(xi, math.nextafter(g.L_XD, 0.0)))))
    # the load share is a ratio of polynomials: eight Gauss nodes a stretch leave about 1e-10
    assert loss_factor(pair, "stiffness") == pytest.approx(expected, rel=1e-8)
    assert loss_factor(pair, "stiffness") < loss_factor(pair)  # less load where sliding is fast


def test_tip_relief_lowers_the_loss_factor_where_it_unloads_the_ends():
    pair = load_gear_pair("nasa_28_28")
    assert loss_factor(pair, "loaded") < loss_factor(pair, "stiffness")
    # With all pairs of the path in contact the shares are k_i (delta - e_i)/F: linear in 1/torque
    deficit = [
        loss_factor(heavy, "stiffness") - loss_factor(heavy, "loaded")
        for heavy in (pair.with_(operating__pinion_torque=torque) for torque in (5000.0, 10000.0))
    ]
    assert deficit[0] / deficit[1] == pytest.approx(2.0, rel=1e-9)  # rounding of a difference of 1e-3


def test_loaded_shares_are_those_of_the_static_transmission_error():
    from lumped.quasi_static import static_transmission_error

    pair = load_gear_pair("nasa_28_28")
    g = geometry(pair)
    static = static_transmission_error(pair, phases=2048, extended=False).isel(torque=0)
    slide = (g.omega_pinion + g.omega_gear) * np.abs(static["position"] - g.L_XP)
    mean = float((static["load_share"] * slide).sum("pair").mean())
    # evenly spaced samples of a sum that jumps at A and D: first order in 1/2048
    assert loss_factor(pair, "loaded") == pytest.approx(
        mean / (g.omega_pinion * g.base_radius_pinion), rel=1e-3
    )


def test_addendum_contact_ratios_add_up():
    for name in preset_names():
        g = geometry(load_gear_pair(name))
        assert sum(addendum_contact_ratios(g)) == pytest.approx(g.contact_ratio, rel=1e-14)


def test_unknown_sharing_is_refused():
    with pytest.raises(ParameterError, match="sharing = equal"):
        loss_factor(load_gear_pair("fzg_c"), "equal")

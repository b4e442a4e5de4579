"""Is the list of cases the one that the study describes, and always the same?"""

import itertools

import numpy as np
import pytest

from validation.studies.cases import CaseList

SAMPLED = [
    {"field": "operating.pinion_torque", "low": 10.0, "high": 90.0},
    {"field": "mesh.damping_ratio", "low": 0.001, "high": 0.1, "spacing": "log"},
    {"field": "centre_distance", "low": 88.9, "high": 89.9},
]


def sampled(make_study, **design) -> CaseList:
    return CaseList(make_study(design=design, axes=SAMPLED))


def test_grid_is_the_product_with_the_last_axis_fastest(make_study):
    cases = CaseList(make_study())
    speeds = np.linspace(500.0, 9000.0, 8).tolist()
    expected = list(itertools.product(speeds, [5.0, 6.0, 8.0], [88.5, 88.9, 89.0, 89.2, 89.4]))
    assert cases.count == 120
    assert cases.values(range(120)) == expected
    assert cases.values([119, 7]) == [expected[119], expected[7]]


def test_latin_hypercube_hits_every_stratum_of_every_axis_once(make_study):
    n = 50
    shares = sampled(make_study, method="latin_hypercube", samples=n).shares(np.arange(n))
    for column in shares.T:
        assert sorted(np.floor(column * n)) == list(range(n))


def test_sobol_points_are_balanced(make_study):
    # 2^m points of a scrambled Sobol sequence: every axis has one point in each of the 2^m equal intervals.
    n = 64
    shares = sampled(make_study, method="sobol", samples=n).shares(np.arange(n))
    for column in shares.T:
        assert sorted(np.floor(column * n)) == list(range(n))


def test_sensitivity_blocks_swap_one_column_each(make_study):
    n, d = 16, 3
    cases = sampled(make_study, method="sobol", samples=n, sensitivity=True)
    assert cases.count == n * (d + 2)
    blocks = cases.shares(np.arange(cases.count)).reshape(d + 2, n, d)
    a, b = blocks[0], blocks[1]
    assert (a != b).all()
    for i in range(d):
        expected = a.copy()
        expected[:, i] = b[:, i]
        np.testing.assert_array_equal(blocks[i + 2], expected)


def test_ranges_are_linear_or_logarithmic_and_hold_their_ends(make_study):
    linear = {"field": "operating.pinion_torque", "low": 1.0, "high": 4.0, "count": 4}
    log = {"field": "mesh.damping_ratio", "low": 0.001, "high": 0.1, "count": 3, "spacing": "log"}
    torque, damping = CaseList(make_study(axes=[linear, log])).grid
    assert torque == (1.0, 2.0, 3.0, 4.0)
    # exp(log x) rounds within a few units of the last place.
    assert damping == pytest.approx((0.001, 0.01, 0.1), rel=1e-14)
    assert damping[-1] <= 0.1


def test_samples_of_a_whole_number_give_every_value_the_same_share(make_study):
    axes = [{"field": "pinion.teeth", "low": 24.5, "high": 28.9}]  # whole numbers inside: 25 to 28
    cases = CaseList(make_study(axes=axes, design={"method": "sobol", "samples": 256}))
    teeth = [values[0] for values in cases.values(range(256))]
    # 256 balanced points over 4 values; exact, because each value owns a dyadic quarter of the range.
    assert [teeth.count(z) for z in (25, 26, 27, 28)] == [64] * 4
    assert all(type(z) is int for z in teeth)


def test_samples_are_as_fine_as_floats(make_study):
    # Of 30 bits, which scipy takes by itself, every share would be a multiple of 2^-30.
    shares = sampled(make_study, method="sobol", samples=16).shares(np.arange(16))
    assert (shares * 2.0**30 % 1.0 != 0.0).all()


def test_the_seed_decides_the_samples(make_study):
    one, same, other = (sampled(make_study, method="sobol", samples=32, seed=seed) for seed in (3, 3, 4))
    assert one.sha256 == same.sha256
    assert one.values(range(32)) == same.values(range(32))
    assert one.sha256 != other.sha256

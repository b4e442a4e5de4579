"""Are the cases those of the study, and the indices those of a function whose indices are known?"""

import dataclasses
import itertools
import math

import numpy as np
import pytest

from validation.studies import read_results, run_sweep
from validation.studies.analyses import ANALYSES
from validation.studies.cases import CaseList
from validation.studies.results import indices

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


@pytest.mark.parametrize(("method", "n"), [("latin_hypercube", 50), ("sobol", 64)])
def test_samples_hit_every_stratum_of_every_axis_once(make_study, method, n):
    # Of 2^m points of a scrambled Sobol sequence every axis has one in each of the 2^m equal intervals.
    shares = sampled(make_study, method=method, samples=n).shares(np.arange(n))
    for column in shares.T:
        assert sorted(np.floor(column * n)) == list(range(n))


def test_sensitivity_blocks_swap_one_column_each(make_study):
    n = 16
    d = 3
    cases = sampled(make_study, method="sobol", samples=n, sensitivity=True)
    assert cases.count == n * (d + 2)
    blocks = cases.shares(np.arange(cases.count)).reshape(d + 2, n, d)
    a = blocks[0]
    b = blocks[1]
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


SAMPLES = 512
A = 7.0
B = 0.1
AXES = [
    {"field": "operating.pinion_torque", "name": "x1", "low": 10.0, "high": 90.0},
    {"field": "mesh.damping_ratio", "name": "x2", "low": 0.0, "high": 0.1},
    {"field": "centre_distance", "name": "x3", "low": 88.9, "high": 89.4},
]


def ishigami(variation, settings):
    """Ishigami and Homma's function of the three axes, each stretched to (-pi, pi)."""
    pair = variation.pair
    inputs = (pair.operating.pinion_torque, pair.mesh.damping_ratio, pair.centre_distance * 1e3)
    x = [
        math.pi * (2.0 * (value - axis["low"]) / (axis["high"] - axis["low"]) - 1.0)
        for value, axis in zip(inputs, AXES, strict=True)
    ]
    x1, x2, x3 = x
    value = math.sin(x1) + A * math.sin(x2) ** 2 + B * x3**4 * math.sin(x1)
    return {"contact_ratio": value, "mesh_frequency": 3.0}


def expected():
    """First-order and total indices by integration (Ishigami and Homma 1990)."""
    v1 = 0.5 * (1.0 + B * math.pi**4 / 5.0) ** 2
    v2 = A**2 / 8.0
    v13 = B**2 * math.pi**8 * (1.0 / 18.0 - 1.0 / 50.0)
    v = v1 + v2 + v13
    return np.array([v1, v2, 0.0]) / v, np.array([v1 + v13, v2, v13]) / v


@pytest.fixture(scope="module")
def result(make_study, tmp_path_factory):
    out = tmp_path_factory.mktemp("ishigami") / "out"
    design = {"method": "sobol", "samples": SAMPLES, "seed": 1, "sensitivity": True}
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(ANALYSES, "geometry", dataclasses.replace(ANALYSES["geometry"], compute=ishigami))
        run_sweep(make_study(design=design, axes=AXES), out)
    return read_results(out)


def test_indices_of_the_ishigami_function(result):
    assert result.sizes["case"] == SAMPLES * 5
    first, total = expected()
    indices = result.sel(output="contact_ratio")
    assert list(indices.axis.to_numpy()) == ["x1", "x2", "x3"]
    # 512 quasi-random points: the error is below that of plain sampling, 1/sqrt(512) = 4 %.
    np.testing.assert_allclose(indices.sobol_first, first, atol=0.03)
    np.testing.assert_allclose(indices.sobol_total, total, atol=0.03)


def test_a_constant_output_has_no_indices_and_says_so(result):
    assert result.sel(output="mesh_frequency").sobol_first.isnull().all()
    assert "not defined for the constant mesh_frequency" in result.attrs["sensitivity"]


def test_a_failed_case_leaves_the_indices_out_and_says_so(make_study, tmp_path):
    *others, distance = AXES
    axes = [*others, {**distance, "low": 88.0}]  # below 88.9 mm the teeth wedge
    design = {"method": "sobol", "samples": 8, "sensitivity": True}
    summary = run_sweep(make_study(design=design, axes=axes), tmp_path / "out")
    result = read_results(tmp_path / "out")
    assert summary.failed > 0
    assert "sobol_first" not in result
    assert result.attrs["sensitivity"].startswith(f"no indices: {summary.failed} of 40 cases failed")


def test_before_the_last_case_there_are_no_indices(make_study, tmp_path):
    seen = []

    def progress(done, total, failed):
        result = read_results(tmp_path / "out")
        seen.append((done, total - done, "sobol_first" in result, result.attrs["sensitivity"]))

    design = {"method": "sobol", "samples": 8, "sensitivity": True}
    run_sweep(make_study(design=design, axes=AXES), tmp_path / "out", progress=progress)
    assert "sobol_first" in read_results(tmp_path / "out")
    done, missing, has_indices, text = seen[0]
    assert (done, missing, has_indices) == (1, 39, False)
    assert text.endswith("39 are not computed yet")


def test_indices_do_not_depend_on_the_unit():
    rng = np.random.default_rng(2)
    values = rng.random((1, 5 * 64))
    one = indices(values, 3)
    other = indices(1e-9 * values + 5.0, 3)
    # A range of 1e-9 about 5 keeps 16 - 10 = 6 digits; the estimators square differences of it.
    np.testing.assert_allclose(one[1], other[1], rtol=1e-5)
    for scale in (1e-200, 1e200):  # where squares vanish and overflow
        scaled = indices(scale * values, 3)
        # The estimators are differences of means of 64 numbers of order 1.
        np.testing.assert_allclose(one[1], scaled[1], rtol=0, atol=1e-12)


def test_where_every_output_is_constant_no_index_is_a_number():
    assert np.isnan(indices(np.full((2, 5 * 8), 3.0), 3)).all()

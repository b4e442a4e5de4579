"""Do variants run in the same machines, and are the machines counted as said?"""

import itertools
import json

import numpy as np
import pytest
from scipy.stats import beta

import spurcheck
from lumped.errors import NumericalError, ParameterError
from tests.evidence.rankings import LIMIT, RESULTS, cases
from tests.unlike_pairs import known_sizes, unlike_pair
from validation.prediction import compare as module
from validation.prediction.compare import as_read, common_draws, compare, of_hundred, ranking

from .test_uncertainty import LINEAR

#: Its transmission error is in proportion to the torque, its dynamic factor does not depend on it.
TORQUE = LINEAR.with_({"uncertainty": {"operating.pinion_torque": "+- 4 %"}})
GREATER = TORQUE.with_(torque=1.02 * TORQUE.operating.pinion_torque)
RELIEVED = known_sizes(unlike_pair("rack_25_degrees_always_pushing")).with_(
    {
        "mesh.relief": "static",
        "assumed": {},
        "uncertainty": {
            "pinion.tip_relief.amount": "+- 2 um",
            "mesh.damping_ratio": "+- 20 %",
            "bearings.gear.loa_stiffness": "/ 2 .. * 2",
        },
    }
    | {
        f"{gear}.tip_relief": {"amount": 8.0, "start_roll_angle": angle}
        for gear, angle in (("pinion", 27.0), ("gear", 22.0))
    }
)


def test_the_load_of_one_machine_is_the_same_in_all_variants():
    """Two per cent more torque is more transmission error in each machine, whatever its torque is."""
    comparison = compare(TORQUE, GREATER, samples=16)
    assert comparison["input"].to_numpy().tolist() == ["operating.pinion_torque"]
    assert float(comparison["better"].sel(result="dte_peak_to_peak", variant="A", other="B")) == 1.0
    ratio = comparison["dte_peak_to_peak"][1] / comparison["dte_peak_to_peak"][0]
    np.testing.assert_allclose(ratio, 1.02, rtol=1e-9)


def test_parts_of_other_size_have_deviations_of_their_own(monkeypatch):
    """Two independent uniform numbers: the smaller one, .96 to 1.04, is above 1.02 times the other in a
    triangle of sides 1.04 - .9792, out of .08 by .0816.
    """
    monkeypatch.setattr(module, "_COMMON", ())
    comparison = compare(TORQUE, GREATER, samples=64)
    assert comparison.sizes["input"] == 2
    expected = (1.04 - 0.9792) ** 2 / 2 / (0.08 * 0.0816)
    # 64 Sobol points count a triangle to two of them; the draws in common would give 0.
    share = float(comparison["better"].sel(result="dte_peak_to_peak", variant="B", other="A"))
    assert share == pytest.approx(expected, abs=2 / 64)
    assert float(comparison["equal"].sel(result="dynamic_factor", variant="A", other="B")) == 1.0


def drawn(*pairs):
    """Field -> the groups of variants that share a draw."""
    letters = {}
    for draw in common_draws(pairs):
        letters.setdefault(draw.path, []).append("".join("ABC"[k] for k in sorted(draw.inputs)))
    return {name: sorted(groups) for name, groups in letters.items()}


AMOUNT, DAMPING, BEARING = (
    "pinion.tip_relief.amount", "mesh.damping_ratio", "bearings.gear.loa_stiffness",
)  # fmt: skip


def test_what_variants_have_in_common_is_one_draw():
    other = RELIEVED.with_(gear__face_width=31.0)
    assert drawn(RELIEVED, other) == {AMOUNT: ["AB"], DAMPING: ["AB"], BEARING: ["AB"]}
    deeper = other.with_({AMOUNT: 14.0})
    assert drawn(RELIEVED, other, deeper) == {AMOUNT: ["AB", "C"], DAMPING: ["ABC"], BEARING: ["ABC"]}
    stiff = RELIEVED.with_({BEARING: 3e8, DAMPING: 0.05})
    assert drawn(RELIEVED, stiff) == {AMOUNT: ["AB"], DAMPING: ["AB"], BEARING: ["A", "B"]}
    stated = RELIEVED.with_({"uncertainty": {AMOUNT: "+- 2 um"}})
    assert drawn(RELIEVED, stated) == {AMOUNT: ["AB"], DAMPING: ["A"], BEARING: ["A"]}
    loose = RELIEVED.with_({"uncertainty": {AMOUNT: "+- 3 um"}})
    assert drawn(RELIEVED, loose)[AMOUNT] == ["A", "B"]


def test_a_range_that_stays_hides_a_difference_and_is_told():
    first = LINEAR.with_({"uncertainty": {DAMPING: "0.02 .. 0.1"}, DAMPING: 0.04})
    second = first.with_({DAMPING: 0.07})
    assert drawn(first, second) == {DAMPING: ["A", "B"]}
    (remark,) = compare(first, second, samples=16).attrs["remarks"]
    assert remark.startswith(f"{DAMPING} differs between variants and its range, 0.02 .. 0.1, does not")
    only = second.with_({"uncertainty": {}})
    (remark,) = compare(first, only, samples=16).attrs["remarks"]
    assert remark.startswith(f"{DAMPING} varies in A only")


def test_gears_of_one_class_are_the_same_gear_and_of_another_class_another():
    pairs = [RELIEVED.with_({"pinion.deviations": {"tolerance_class": k}}) for k in (6, 6, 7)]
    pairs[1] = pairs[1].with_(gear__face_width=31.0)
    assert drawn(*pairs)["pinion.deviations.seed"] == ["AB", "C"]


@pytest.fixture(scope="module")
def three():
    variants = [RELIEVED, RELIEVED.with_({AMOUNT: 9.0}), RELIEVED.with_(torque=252.0)]
    return variants, compare(*variants, samples=32)


def test_each_number_of_a_machine_is_that_of_its_own_inputs(three):
    variants, comparison = three
    assert set(comparison["input"].to_numpy()) == {f"{AMOUNT} (A, C)", f"{AMOUNT} (B)", DAMPING, BEARING}
    for sample, (letter, pair) in itertools.product((0, 17), zip("ABC", variants, strict=True)):
        share = comparison["share"].isel(sample=sample)
        u = float(share.sel(input=f"{AMOUNT} (B)" if letter == "B" else f"{AMOUNT} (A, C)"))
        stiffness = pair.bearings.gear.loa_stiffness
        varied = pair.with_(
            {
                AMOUNT: (9.0 if letter == "B" else 8.0) - 2.0 + 4.0 * u,
                DAMPING: pair.mesh.damping_ratio * (0.8 + 0.4 * float(share.sel(input=DAMPING))),
                BEARING: stiffness * 4.0 ** (float(share.sel(input=BEARING)) - 0.5),
            }
        )
        numbers = spurcheck.predict(varied).numbers
        for name in RESULTS:
            ours = float(comparison[name].isel(sample=sample).sel(variant=letter))
            assert ours == pytest.approx(numbers[name], rel=1e-7), (sample, letter, name)


def test_shares_are_counted_as_said(three):
    """Counted again by loops over the machines; the interval by quantiles of the beta distribution."""
    _, comparison = three
    n = comparison.sizes["sample"]
    for name, larger in RESULTS.items():
        sign = -1.0 if larger else 1.0
        cost = sign * comparison[name].to_numpy()
        as_given = sign * comparison[f"{name}_given"].to_numpy()
        result = comparison.sel(result=name)
        for i, j in itertools.permutations(range(3), 2):
            assert float(result["better"][i, j]) == np.mean([cost[i, k] < cost[j, k] for k in range(n)])
            difference = sign * (cost[i] - cost[j])
            percentiles = np.percentile(difference, [5.0, 50.0, 95.0])
            np.testing.assert_allclose(comparison[f"{name}_difference"][i, j], percentiles, rtol=1e-9)
        order = np.argsort(as_given)
        holding = sum(bool((np.argsort(cost[:, k]) == order).all()) for k in range(n))
        assert float(result["holds"]) == holding / n
        low, high = result["holds_interval"].to_numpy()
        assert low == pytest.approx(beta.ppf(0.05, holding, n - holding + 1) if holding else 0.0)
        assert high == pytest.approx(beta.ppf(0.95, holding + 1, n - holding) if holding < n else 1.0)
        best = [float(np.mean([cost[:, k].argmin() == i for k in range(n)])) for i in range(3)]
        np.testing.assert_allclose(result["best"], best)
        assert result["place"].to_numpy().tolist() == (1 + np.argsort(order)).tolist()


def test_what_no_variant_changes_is_equal():
    """Without friction the oil is not read."""
    comparison = compare(TORQUE, TORQUE.with_(lubricant__viscosity=20.0), samples=16)
    for name in RESULTS:
        result = comparison.sel(result=name)
        assert (float(result["equal"][0, 1]), float(result["holds"]), float(result["better"].max())) == (
            1.0,
            1.0,
            0.0,
        )
        assert ranking(result["place"].to_numpy().tolist(), "AB") == "A = B"
        assert str(result["sentence"].item()).startswith(
            "A and B are equal in 100 of 100 possible machines: "
        )


def test_a_machine_without_prediction_in_one_variant_counts_in_none():
    tables = LINEAR.with_({"uncertainty": {"mesh.stiffness": ["rectangular", "table"]}})
    plain = TORQUE.with_(gear__face_width=31.0)
    comparison = compare(plain, tables, samples=16)
    assert comparison.attrs["refused"] == 16 - comparison.sizes["sample"] == 8
    assert comparison["dte_peak_to_peak"].notnull().all()
    never = LINEAR.with_({"uncertainty": {"mesh.stiffness": ["table", "table"]}})
    with pytest.raises(NumericalError, match="Only 0 of 16 samples have a prediction in every variant"):
        compare(plain, never, samples=16)


def test_teeth_that_differ_add_their_own_transmission_error():
    index = [6.0] + [0.0] * (TORQUE.pinion.teeth - 1)
    wrong = TORQUE.with_({"pinion.deviations": {"index": index}})
    comparison = compare(TORQUE, wrong, samples=16)
    assert comparison.attrs["teeth"] == "as given"
    name = "revolution_dte_peak_to_peak"
    like, different = comparison[f"{name}_given"].to_numpy()
    # Peaks between 32 times of a mesh cycle are those of a cubic.
    for value, pair in ((like, TORQUE), (different, wrong)):
        assert value == pytest.approx(spurcheck.steady_state(pair).attrs["dte_peak_to_peak"], rel=0.01)
    assert float(comparison["holds"].sel(result=name)) == 1.0


@pytest.mark.parametrize(
    ("share", "words"),
    [(0.0, 0), (1 / 1024, 1), (0.004, 1), (0.5, 50), (0.97, 97), (1023 / 1024, 99), (1.0, 100)],
)
def test_none_and_all_are_said_of_none_and_all(share, words):
    assert of_hundred(share) == words


def said(better, worse, values=(4.2e-6, 3.1e-6), place=(2, 1)):
    """Sentence where B is better and worse in these shares."""
    shares = {
        "better": [np.array([[0.0, worse], [better, 0.0]])],
        "equal": [np.array([[1.0, 1 - better - worse], [1 - better - worse, 1.0]])],
        "best": [np.array([1 - better, 1 - worse])],
        "place": [np.array(place)],
    }
    return module._sentence("dte_peak_to_peak", np.array(values), shares, "AB")


@pytest.mark.parametrize(
    ("case", "words"),
    [
        (
            said(0.96875, 0.03125),
            "B is better than A in 97 of 100 possible machines: transmission error 3.10 µm against 4.20 µm.",
        ),
        (said(0.8125, 0.1875), "B is better than A in 81 of 100"),
        (
            said(0.78125, 0.21875),
            "No difference that these inputs can show: transmission error 3.10 µm against 4.20 µm; "
            "B is better than A in 78 of 100 possible machines.",
        ),
        (said(0.21875, 0.78125), "No difference that these inputs can show: transmission error 4.2"),
        (said(0.125, 0.875), "A is better than B in 88 of 100 possible machines, though not with the values"),
        (said(0.75, 0.0), "B is better than A in 75 of 100 possible machines, equal in 25: "),
        (said(0.1, 0.09), "A and B are equal in 81 of 100 possible machines: transmission error A 4.2"),
    ],
)
def test_the_sentence_says_who_is_better_and_where_nobody_is(case, words):
    assert case.replace("\u00a0", " ").startswith(words)


def test_numbers_beside_each_other_have_one_unit_and_are_told_apart():
    assert as_read("dte_peak_to_peak", np.array([3.1e-6, 9.5e-7])) == (["3.10", "0.95"], "\u00a0µm")
    assert as_read("dynamic_factor", np.array([1.0402, 1.0398])) == (["1.0402", "1.0398"], "")
    assert as_read("efficiency", np.array([0.99571, 0.9961])) == (["99.57", "99.61"], "\u00a0%")
    tiny = np.array([-6.6e-7, 5.2e-5]), 2, np.array([6.2e-5, 7e-5])
    assert as_read("dte_peak_to_peak", *tiny) == (["−1", "52"], "\u00a0µm")
    assert as_read("tooth_load", np.array([-1e-9, 0.5]), 2) == (["0.00", "0.50"], "")
    assert as_read("bearing_rms", np.array([0.0, 0.0])) == (["0", "0"], "\u00a0N")


def test_what_cannot_be_compared_is_refused():
    with pytest.raises(ParameterError, match="variants = 1: allowed 2 to 26"):
        compare(TORQUE)
    with pytest.raises(ParameterError, match=r"variants = A and C.*They are equal"):
        compare(TORQUE, GREATER, TORQUE.with_(name="other"))
    with pytest.raises(ParameterError, match=r"names = .*allowed 2 texts"):
        compare(TORQUE, GREATER, names=["one"])
    with pytest.raises(ParameterError, match="uncertainty = none"):
        compare(TORQUE.with_(uncertainty={}), GREATER.with_(uncertainty={}))
    with pytest.raises(ParameterError, match="Did you mean 'nasa_28_28'"):
        compare(TORQUE, "nasa_2828")


def test_variants_of_one_name_say_where_they_differ():
    assert module._names([TORQUE, GREATER], None) == [
        TORQUE.name,
        f"{TORQUE.name}, other operating.pinion_torque",
    ]
    assert module._names([TORQUE, GREATER], ["light", "heavy"]) == ["light", "heavy"]


def test_the_stored_shares_are_those_of_plain_monte_carlo(request):
    """`python -m tests.evidence.rankings` computes them; 35 shares of seven pairs of variants."""
    path = request.config.rootpath / "docs" / "verification" / "rankings.json"
    stored = json.loads(path.read_text("utf-8"))
    assert [one["key"] for one in stored["cases"]] == [one.key for one in cases()]
    shares = [row for one in stored["cases"] for row in one["results"].values()]
    assert len(shares) == 35
    assert [row for row in shares if 100.0 * abs(row["compare"] - row["plain"]) > LIMIT] == []
    undecided = sum(0.2 < row["plain"] < 0.8 for row in shares)
    assert 5 < undecided < 30  # of both kinds


@pytest.mark.parametrize("case", cases(), ids=lambda case: case.key)
def test_each_variant_draws_its_own_inputs_where_the_case_says_so(case):
    drawn_apart = {name for name, groups in drawn(*case.variants).items() if groups == ["A", "B"]}
    assert drawn_apart == set(case.own)

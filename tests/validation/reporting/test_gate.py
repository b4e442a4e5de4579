"""Does the regression gate let through what may change, and stop what may not?"""

import copy
import json

import pytest

from lumped import ParameterError
from validation.reporting.gate import compare, failures, load_report


def state(word):
    return {"state": word, "text": word}


@pytest.fixture
def document():
    """The layout of report.json with one of everything."""
    return {
        "format": "spurcheck-report",
        "format_version": 1,
        "gear_pair": "pair",
        "quick": False,
        "verdict": "It holds.",
        "doubts": [],
        "answers": [
            {"question": "Stable?", "verdict": state("stable"), "text": "yes", "chapter": "stability"},
        ],
        "chapters": {
            "stability": {
                "title": "Stability",
                "verdict": state("stable"),
                "margins": {
                    "radius": {"label": "largest multiplier", "value": 0.8},
                    "error": {"label": "bound on its error", "value": 1e-12},
                    "nearest": {"label": "nearest", "value": {"value": 4000.0, "unit": "rpm"}},
                },
                "figures": ["chart"],
                "text": [["words"]],
            },
            "cross_check": {
                "title": "Cross-check",
                "verdicts": [
                    {"quantity": "dte", "fidelity": "linear", "value": 2e-9, "verdict": state("within")},
                    {"quantity": "dte", "fidelity": "exact", "value": 0.02, "verdict": state("within")},
                ],
                "orders": [
                    {"quantity": "dte", "order": 1, "lumped": {"value": 5e-6, "unit": "m"}},
                    {"quantity": "load", "order": 1, "lumped": {"value": 300.0, "unit": "N"}},
                ],
            },
            "provenance": {
                "title": "Versions",
                "made_from": {"parameters_sha256": {"label": "SHA", "value": "0" * 64}},
                "versions": [{"name": "numpy", "version": "2.0"}],
            },
        },
        "parameters": {"mesh": {"damping_ratio": 0.05}},
        "timestamps": {"created": "2020"},
    }


def at(document, *path):
    for key in path[:-1]:
        document = document[key]
    return document, path[-1]


def test_a_report_is_unchanged_against_itself(document):
    found = compare(document, copy.deepcopy(document))
    assert found.changes == ()
    # Every leaf above but labels, titles, versions, timestamps and texts: answers 1, stability 4, cross-check
    # 2 * 4 + 2 * 3, hash 1, parameter 1.
    assert found.compared == 21


RADIUS = ("chapters", "stability", "margins", "radius", "value")
BOUND = ("chapters", "stability", "margins", "error", "value")
EXACT = ("chapters", "cross_check", "verdicts", 1, "value")
LINEAR = ("chapters", "cross_check", "verdicts", 0, "value")
AMPLITUDE = ("chapters", "cross_check", "orders", 0, "lumped", "value")
VERDICT = ("chapters", "cross_check", "verdicts", 1, "verdict")


@pytest.mark.parametrize(
    ("path", "value", "fails"),
    [
        (RADIUS, 0.8 * (1 + 0.9e-3), False),
        (RADIUS, 0.8 * (1 + 1.2e-3), True),
        (RADIUS, 0.8 * (1 - 1.2e-3), True),
        (RADIUS, None, True),  # a number that is not finite is written as null
        (BOUND, 1e-10, False),  # a hundred times rounding is rounding
        (BOUND, 2e-9, True),
        (BOUND, 1e-15, False),
        (EXACT, 0.0202, True),
        (LINEAR, 4e-9, False),  # nothing beside 0.02
        (AMPLITUDE, 5.1e-6, True),  # something beside 300 of another unit
        (VERDICT, state("outside"), True),
        (("answers", 0, "verdict"), state("undecided"), True),
        (("answers", 0, "verdict"), state("confirmed"), False),  # other words for good
        (("parameters", "mesh", "damping_ratio"), 0.06, False),
        (("chapters", "provenance", "made_from", "parameters_sha256", "value"), "1" * 64, False),
        (("chapters", "stability", "margins", "nearest", "value"), "none in the range", True),
        (("chapters", "stability", "margins", "nearest", "value", "unit"), "rad/s", True),
    ],
)
def test_what_may_change_and_what_may_not(document, path, value, fails):
    new = copy.deepcopy(document)
    place, key = at(new, *path)
    place[key] = value
    found = compare(document, new)
    assert len(found.changes) == 1
    assert bool(found.regressions) is fails


def test_a_verdict_that_gets_better_passes(document):
    old = copy.deepcopy(document)
    old["answers"][0]["verdict"] = state("unstable")
    found = compare(old, document)
    assert [str(change) for change in found.changes] == ["answers/Stable?: unstable -> stable"]
    assert not found.regressions


def test_what_is_gone_fails_and_what_is_new_does_not(document):
    fewer = copy.deepcopy(document)
    del fewer["chapters"]["cross_check"]
    assert len(compare(document, fewer).regressions) == 14  # every leaf of the chapter
    assert not compare(fewer, document).regressions
    fewer = copy.deepcopy(document)
    del fewer["chapters"]["stability"]["margins"]["radius"]
    gone = compare(document, fewer)
    assert [str(c) for c in gone.regressions] == ["stability/margins/radius: 0.8 -> gone"]
    assert not compare(fewer, document).regressions


def test_a_number_is_small_beside_those_of_its_own_unit(document):
    small = {"quantity": "x", "order": 1, "lumped": {"value": 1e-12, "unit": "m"}}
    document["chapters"]["cross_check"]["orders"].append(small)
    new = copy.deepcopy(document)
    # 1e-13 m beside a ten-thousandth of 5e-6 m is 2e-4, below the tolerance.
    new["chapters"]["cross_check"]["orders"][2]["lumped"]["value"] = 1.1e-12
    assert not compare(document, new).regressions
    # Beside 1e-12 m alone it is ten percent.
    del document["chapters"]["cross_check"]["orders"][0]
    del new["chapters"]["cross_check"]["orders"][0]
    assert compare(document, new).regressions


def test_a_table_of_errors_may_grow_tenfold(document):
    document["chapters"]["code_verification"] = {
        "title": "Code",
        "evidence": [{"kind": "orders", "use": 2e-7}],
    }
    for factor, fails in ((0.1, False), (9.0, False), (11.0, True)):
        new = copy.deepcopy(document)
        new["chapters"]["code_verification"]["evidence"][0]["use"] *= factor
        assert bool(compare(document, new).regressions) is fails, factor


def test_remarks_are_no_results(document):
    new = copy.deepcopy(document)
    chapter = new["chapters"]["stability"]
    chapter |= {"captions": {"chart": "words"}, "tables": {"a": {"caption": "words", "note": "more"}}}
    chapter["margins"]["radius"]["note"] = "stable below 1"
    assert compare(document, new).changes == ()
    assert compare(new, document).changes == ()


def test_rows_are_matched_by_name_not_by_place(document):
    new = copy.deepcopy(document)
    new["chapters"]["cross_check"]["verdicts"].reverse()
    assert compare(document, new).changes == ()


def test_a_row_that_is_left_out_renames_no_other(document):
    # Rows that words do not tell apart are named by a whole number: one that is left out renames no other.
    orders = document["chapters"]["cross_check"]["orders"]
    orders += [{"quantity": "dte", "order": k, "lumped": {"value": k * 1e-6, "unit": "m"}} for k in (2, 3)]
    new = copy.deepcopy(document)
    del new["chapters"]["cross_check"]["orders"][2]
    assert {c.path for c in compare(document, new).changes} == {
        "cross_check/orders/dte, 2/order",
        "cross_check/orders/dte, 2/lumped",
        "cross_check/orders/dte, 2/quantity",
    }


def test_the_tolerance_is_the_users(document):
    new = copy.deepcopy(document)
    new["chapters"]["stability"]["margins"]["radius"]["value"] = 0.82
    assert compare(document, new, tolerance=0.05).regressions == ()
    assert "2.44 %" in str(compare(document, new).regressions[0])  # 0.02/0.82
    with pytest.raises(ParameterError, match="--tolerance"):
        compare(document, new, tolerance=-1.0)


def test_a_state_is_a_verdict_and_a_marked_row_is_not(document):
    document["chapters"]["validity"] = {
        "title": "Validity",
        "flags": [
            {"key": "Teeth stay in contact", "state": state("violated"), "value": -3.0},
            {"key": "Torques balance", "state": state("ok"), "assumed": state("violated")},
        ],
    }
    assert failures(document) == ("validity.flags: Teeth stay in contact: violated",)
    document["chapters"]["cross_check"]["verdict"] = document["answers"][0]["verdict"] = state("outside")
    assert failures(document) == (
        "answers: Stable?: outside",
        "cross_check: Cross-check: outside",
        "validity.flags: Teeth stay in contact: violated",
    )


@pytest.mark.parametrize("content", ["", "[1]", "{}", '{"format": "spurcheck-report"}', "[" * 100_000])
def test_files_that_are_no_report_are_refused(tmp_path, content):
    path = tmp_path / "report.json"
    path.write_text(content)
    for source in (path, tmp_path):
        with pytest.raises(ParameterError, match="--compare"):
            load_report(source, quick=False)
    with pytest.raises(ParameterError):
        load_report(tmp_path / "none.json", quick=False)


@pytest.mark.parametrize(
    ("path", "value", "says"),
    [
        (RADIUS, float("nan"), "NaN is no number"),
        (RADIUS, float("inf"), "Infinity is no number"),
        (RADIUS, 10**400, "as it was written"),
        (("format_version",), 0, "spurcheck-report 0: write the earlier report again"),
        (("chapters",), [], "as it was written"),
        (("chapters", "stability"), None, "as it was written"),
        (("answers",), [{}], "as it was written"),
        (("chapters", "stability", "margins", "nearest", "value", "value"), "far", "as it was written"),
        (
            ("quick",),
            True,
            "a full report, as the new one. The earlier one is a quick report: sample both alike",
        ),
    ],
)
def test_a_baseline_that_cannot_serve_is_refused_with_what_to_do(document, tmp_path, path, value, says):
    place, key = at(document, *path)
    baseline = tmp_path / "report.json"
    baseline.write_text(json.dumps(document))
    assert load_report(baseline, quick=False) == document
    place[key] = value
    baseline.write_text(json.dumps(document))
    with pytest.raises(ParameterError) as refused:
        load_report(baseline, quick=False)
    assert says in str(refused.value)


def test_a_baseline_cut_short_is_refused(document, tmp_path):
    baseline = tmp_path / "report.json"
    baseline.write_text(json.dumps(document)[:-40])
    with pytest.raises(ParameterError, match="only a part of one"):
        load_report(baseline, quick=False)

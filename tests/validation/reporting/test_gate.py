"""Does the comparison with an earlier report fail where a number moved, and only there?"""

import copy
import json

import pytest

from lumped.errors import ParameterError
from validation.reporting.gate import compare, load_report


def test_a_report_is_like_itself(written):
    comparison = compare(written.document, written.document)
    assert comparison.changes == ()
    assert comparison.compared > 100


@pytest.mark.parametrize(("factor", "fails"), [(1.0005, False), (1.002, True)])
def test_a_number_beyond_the_tolerance_fails(written, factor, fails):
    new = copy.deepcopy(written.document)
    new["numbers"]["dte_peak_to_peak"]["value"] *= factor
    new["chapters"]["forces"]["forces"][0]["value"]["value"] *= factor
    comparison = compare(written.document, new)
    assert len(comparison.changes) == 2
    assert all(change.fails is fails for change in comparison.changes)
    assert bool(comparison.regressions) is fails


def test_a_worse_verdict_fails_and_a_better_one_does_not(written):
    worse = copy.deepcopy(written.document)
    worse["verdict"]["kind"] = "BROKEN"
    assert [c.path for c in compare(written.document, worse).regressions] == ["verdict"]
    assert compare(worse, written.document).regressions == ()


def test_what_is_gone_fails_and_what_is_new_does_not(written):
    less = copy.deepcopy(written.document)
    del less["chapters"]["forces"]["forces"]
    assert compare(written.document, less).regressions
    assert not compare(less, written.document).regressions


def test_changed_parameters_are_shown_and_do_not_fail(written):
    new = copy.deepcopy(written.document)
    new["parameters"]["mesh"]["damping_ratio"] = 0.07
    comparison = compare(written.document, new)
    assert [(c.path, c.fails) for c in comparison.changes] == [("parameters/mesh/damping_ratio", False)]


def test_errors_of_the_numerics_are_not_compared(written):
    new = copy.deepcopy(written.document)
    for row in new["chapters"]["second_program"]["conservation"]:
        row["value"] = 3.0 * row["value"]
    assert compare(written.document, new).changes == ()


def test_only_a_report_of_this_layout_and_sampling_is_taken(written, tmp_path):
    assert load_report(written.folder, quick=False)["gear_pair"] == written.document["gear_pair"]
    with pytest.raises(ParameterError, match="--quick"):
        load_report(written.folder, quick=True)
    other = tmp_path / "report.json"
    other.write_text(json.dumps({"format": "spurcheck-report", "format_version": 1}), encoding="utf-8")
    with pytest.raises(ParameterError, match="this layout"):
        load_report(other, quick=False)
    other.write_text("{", encoding="utf-8")
    with pytest.raises(ParameterError, match="no JSON"):
        load_report(other, quick=False)

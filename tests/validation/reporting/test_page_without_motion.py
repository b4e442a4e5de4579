"""Page 1 of pairs that have no motion: verdict with the reason, static rows, and what to change."""

import json
import math

import numpy as np
import pytest

from lumped import load_gear_pair, static_transmission_error
from lumped.errors import BeyondFlanksError, NumericalError, SlowPairError
from lumped.model.averaged import modes
from tests.unlike_pairs import unlike_pair
from validation.exchange import read_netcdf
from validation.exchange.new_pair_file import new_pair
from validation.prediction.static import StaticPair
from validation.reporting import page_without_motion as module
from validation.reporting import report
from validation.reporting.effort import QUICK
from validation.reporting.page_without_motion import first_page, page_without_motion
from validation.reporting.results import Results
from validation.reporting.verdict import Verdict

#: Drawn pairs 9, 74 and 999 of docs/verification/answers.md.
OVERLOADED = new_pair(
    (49, 197), 0.43, 4.03, 451, 10.4,
    {"mesh.stiffness.model": "parabolic", "friction.law": "xu_kahraman"},
)  # fmt: skip
UNDERCUT = new_pair(
    (10, 35), 0.459, 4.42, 448, 1.46, {"mesh.stiffness.model": "energy", "friction.law": "xu_kahraman"}
)
SLOW = new_pair(
    (56, 41), 0.524, 2.75, 5.62, 0.155,
    {
        "mesh.stiffness.model": "parabolic", "bearings.stiffness": 1.82e13,
        "pinion.profile_shift": 0.46, "gear.profile_shift": -0.37,
    },
)  # fmt: skip
CASES = {
    "overloaded": (OVERLOADED, BeyondFlanksError, Verdict.DO_NOT_RUN, "beyond its flanks"),
    "undercut": (UNDERCUT, BeyondFlanksError, Verdict.OUTSIDE, "beyond its flanks"),
    "slow": (SLOW, SlowPairError, Verdict.UNCERTAIN, "the static values stand in"),
}


@pytest.mark.parametrize("name", CASES)
def test_the_report_is_written_with_the_reason(tmp_path, name):
    pair, kind, verdict, words = CASES[name]
    early = []
    written = report(pair, tmp_path / "out", quick=True, early=lambda title, rows: early.append(rows))
    assert isinstance(Results(pair, QUICK).without_motion, kind)
    assert written.first.verdict is verdict
    assert words in written.first.headline
    assert written.findings == {"contact", "stable", "holds"}
    assert not written.failed
    data = json.loads((tmp_path / "out" / "report.json").read_text("utf-8"))
    assert list(data["chapters"]) == ["at_rest", "inputs", "evidence"]
    assert {row.key for row in written.first.numbers} == set(data["numbers"])
    assert {"static_force", "mesh_stiffness", "mesh_mode", "resonance"} <= set(data["numbers"])
    assert all(math.isfinite(row.value) for row in written.first.numbers)
    assert written.first.actions
    assert [row.key for row in early[0]][:1] == ["static_force"]
    page = (tmp_path / "out" / "index.html").read_text("utf-8")
    assert written.first.actions[0].text in page
    static = tmp_path / "out" / "data" / "static.nc"
    assert static.exists() == ("static_peak_to_peak" in data["numbers"])
    if static.exists():
        swing = float(read_netcdf(static)["peak_to_peak"][0])
        assert swing == data["numbers"]["static_peak_to_peak"]["value"]


def test_the_largest_torque_has_a_motion_and_three_per_cent_more_has_none():
    static = StaticPair(OVERLOADED)
    modes(OVERLOADED.with_(torque=static.largest_torque))
    with pytest.raises(BeyondFlanksError):
        modes(OVERLOADED.with_(torque=1.03 * static.largest_torque))
    limit = float(module.actions_without_motion(Results(OVERLOADED, QUICK), BeyondFlanksError("x"))[0]
                  .command.split('"')[1].split()[0])  # fmt: skip
    assert 0.9 * static.largest_torque < limit <= static.largest_torque


@pytest.mark.parametrize("name", ["contact_ratio_2_3_on_shafts", "heavily_relieved_under_load"])
def test_static_numbers_of_a_pair_with_a_motion(name):
    """The force is torque over base radius; a tooth carries at most what all carry together."""
    pair = unlike_pair(name).healthy
    static = StaticPair(pair)
    torque = pair.operating.pinion_torque
    assert static.largest_torque == torque
    assert static.mesh_force == pytest.approx(torque / pair.geometry.base_radius_pinion, rel=1e-14)
    sharing = static_transmission_error(pair)
    np.testing.assert_allclose(sharing["normal_load"].sum("pair"), static.mesh_force, rtol=1e-9)
    assert 1.0 / static.loaded_pairs <= static.tooth_load <= 1.0 + 1e-12
    assert 0.9 < static.efficiency < 1.0


def test_a_result_of_page_1_that_fails_leaves_the_prediction(monkeypatch):
    pair = load_gear_pair("nasa_28_28")
    results = Results(pair, QUICK)

    def fails(results):
        raise NumericalError("The chart fails: try something else.")

    monkeypatch.setattr(module, "page_one", fails)
    page = first_page(results)
    assert page.verdict is Verdict.UNCERTAIN
    assert "The chart fails" in page.reason
    values = {row.key: row.value for row in page.numbers}
    assert values["dynamic_factor"] == results.prediction.dynamic_factor
    assert "static_force" in values


def test_another_error_says_do_not_run():
    page = page_without_motion(Results(OVERLOADED, QUICK), NumericalError("It grows without bound."))
    assert page.verdict is Verdict.DO_NOT_RUN
    assert "grows without bound" in page.reason


def test_a_failure_is_computed_once(monkeypatch):
    calls = []

    def fails(pair):
        calls.append(pair)
        raise NumericalError("none")

    monkeypatch.setattr("validation.reporting.results.predicted", fails)
    results = Results(OVERLOADED, QUICK)
    for _ in range(3):
        with pytest.raises(NumericalError, match="none"):
            results.prediction  # noqa: B018
    assert len(calls) == 1

"""Did no kill of the stored run do harm, and would the judge see half a report, and other bytes?"""

import json

import pytest

from tests.evidence.kills import KILLS, TARGET, Kill, kills_of_sweeps, left_of_report, moments
from validation.files.folder import CONTENTS


def test_no_kill_of_the_stored_run_left_anything_half_written():
    kills = [Kill(**one) for one in json.loads(TARGET.read_text("utf-8"))["kills"]]
    assert all(kill.good for kill in kills)
    for command in ("report", "sweep"):
        before_the_end = [kill for kill in kills if kill.command == command and not kill.ended]
        assert len(before_the_end) >= 0.8 * KILLS
        assert max(kill.moment for kill in before_the_end) > 0.8
    assert any(kill.hidden for kill in kills)


def test_moments_are_spread_over_the_whole_run():
    chosen = moments(20, 7)
    assert chosen == sorted(chosen)
    assert all(k / 20 <= moment / 1.05 <= (k + 1) / 20 for k, moment in enumerate(chosen))


def test_half_a_report_is_seen(tmp_path):
    out = tmp_path / "out"
    assert left_of_report(out) == "nothing"
    out.mkdir()
    assert left_of_report(out).startswith("half a folder")
    (out / "report.json").write_text("{}")
    (out / CONTENTS).write_text(json.dumps({"files": ["report.json", "index.html"]}))
    assert left_of_report(out) == "half a folder: index.html is missing"
    (out / "index.html").write_text("")
    assert left_of_report(out) == "a complete folder"


@pytest.mark.slow
def test_a_killed_sweep_resumes_to_the_same_bytes():
    kills = []
    kills_of_sweeps(1, 3, kills.append)
    assert [kill.good for kill in kills] == [True]

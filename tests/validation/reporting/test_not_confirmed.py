"""Does a report of a program with a fault say in every place that its numbers are not to be relied on?"""

import re

import pytest

from tests.evidence.faults.fault import FAULTS
from tests.evidence.faults.rewriting import applied
from validation.reporting.build import answer_figure, answers, document, written
from validation.reporting.chapters import CHAPTERS
from validation.reporting.gate import failures
from validation.reporting.page import render
from validation.reporting.results import Results


@pytest.fixture(scope="module")
def report(pair, sharing, no_variant):
    """Data and page of a report, computed with the fault but for the response over speed and the tongues.

    The gears have another pressure angle in operation than the rack has, so that the pitch point moves.
    """
    with applied(FAULTS["pitch_point"]):
        wide = pair.with_({"centre_distance": None, "pinion.profile_shift": 0.2})
        results = sharing(wide, names=("sweep", "margins"))
        chapters = written(results, CHAPTERS)
        data = document(results, chapters, quick=True)
    figures = {key: "" for chapter in data["chapters"].values() for key in chapter.get("figures", [])}
    stamped = data | {"timestamps": {"created": "", "seconds": {"all": 0.0}}}
    figures["answer"] = ""
    page = render(wide, answer_figure(results), answers(results, chapters), chapters, figures, stamped)
    return data, re.sub(r"\s+", " ", re.sub(r"<[^>]+>", " ", page))


def test_the_headline_says_do_not_rely_and_states_no_efficiency(report):
    data, _ = report
    assert data["verdict"].startswith("Do not rely on this prediction: the cross-check of the program fails")
    assert "no mesh efficiency, because a conservation law does not hold" in data["verdict"]
    assert "the prediction holds" not in data["verdict"]
    assert re.search(r"transmission error \S+\s% off with the same equations, limit", data["verdict"])


def test_nothing_on_the_page_says_that_a_model_confirms(report):
    _, text = report
    assert "confirms it" not in text
    assert "● confirmed" not in text


def test_every_chapter_on_the_motion_warns_and_every_verdict_on_it_is_bad(report):
    data, _ = report
    for key in ("steady_state", "losses"):
        assert data["chapters"][key]["text"][0][0].startswith("Warning: do not rely on"), key
    states = {key: chapter.get("verdict", {}).get("state") for key, chapter in data["chapters"].items()}
    assert states["losses"] == "violated"
    assert states["cross_check"] == "fails"
    note = data["chapters"]["steady_state"]["key_results"]["total_efficiency"]["note"]
    assert "do not rely on it" in note
    named = {line.split(": ")[1] for line in failures(data)}
    assert {"What does the model predict?", "Does the independent model agree?"} <= named


def test_what_other_reports_share_is_of_the_sound_program(report, computed, pair, tiny):
    # With the gears of that pair the fault moves the pitch point by its last digit, which only bytes show.
    assert computed.sweep.identical(Results(pair, tiny).sweep)

"""Are the chapters complete, do they say what was computed, and can their verdicts fail?"""

import ast
import dataclasses
import inspect
import json

import numpy as np
import pytest
import xarray as xr

import lumped
from lumped import NumericalError
from multibody.run.effects import CAUSES
from validation.reporting import cross_check_words
from validation.reporting.blocks import Fact, Picture, Table, plain
from validation.reporting.build import document as document_of
from validation.reporting.build import written
from validation.reporting.chapters import (
    CHAPTERS,
    code_verification,
    cross_check,
    parameters,
    solution_verification,
    stability,
)
from validation.reporting.page import layers, numbered
from validation.reporting.results import FULL, QUICK
from validation.reporting.words import sentence
from validation.verification import refinements

ASKED = [
    "steady_state",
    "cross_check",
    "contact_loss",
    "contact_forms",
    "stability",
    "stability_margins",
    "validity",
    "validity_map",
    "losses",
    "parameters",
    "limitations",
    "path_of_contact",
    "mesh_physics",
    "tooth_stiffness",
    "code_verification",
    "solution_verification",
    "provenance",
]


def test_the_report_has_every_chapter_a_verifier_asks_for(chapters):
    assert list(chapters) == ASKED


def test_every_block_is_in_one_layer_and_figures_and_tables_are_counted_through(chapters):
    by_key = {chapter.key: chapter for chapter in CHAPTERS}
    front, evidence = layers(tuple((by_key[key], content) for key, content in chapters.items()))
    shown = [id(block) for part in (*front, *evidence) for block in part.blocks]
    assert sorted(shown) == sorted(id(block) for content in chapters.values() for block in content.blocks)
    # What decides comes first; what only an examiner reads does not.
    assert [part.chapter.key for part in front] == ASKED[:10]
    keys = {block.key for part in front for block in part.blocks if isinstance(block, Table | Picture)}
    assert {"speed_sweep", "flags", "stability_chart", "efficiency_by_law"} <= keys
    assert not {"metrics", "orders", "parameters", "multipliers_table", "evidence"} & keys
    assert len({part.anchor for part in (*front, *evidence)}) == len(front) + len(evidence)
    for kind, first in ((Picture, 2), (Table, 1)):  # figure 1 is that of the first page
        blocks = [b for part in (*front, *evidence) for b in part.blocks if isinstance(b, kind)]
        counted = [numbered((*front, *evidence))[id(block)] for block in blocks]
        assert counted == list(range(first, first + len(blocks)))


def test_every_name_of_a_front_block_exists(chapters):
    # This pair has no shafts; test_four_springs looks at that chapter.
    assert {chapter.key for chapter in CHAPTERS} - {"four_springs"} == set(chapters)
    for chapter in (one for one in CHAPTERS if one.key in chapters):
        keys = {getattr(block, "key", None) for block in chapters[chapter.key].blocks}
        missing = set(chapter.front) - keys
        # A preset has no parameters of its own; without damping there may be no tongue. At the operating
        # speed of this pair no teeth part, and near it there is no jump.
        assert missing <= {"given", "tongues_table", "contact_loss", "jumps"}, chapter.key


def test_a_chapter_imports_no_other_chapter():
    for chapter in CHAPTERS:
        tree = ast.parse(inspect.getsource(inspect.getmodule(chapter.write)))
        modules = [node.module for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)]
        assert not [name for name in modules if name.startswith("validation.reporting.chapters")], chapter.key


def test_a_quick_report_says_nothing_of_verification(pair, sharing):
    quick = sharing(pair)
    keys = {chapter.key for chapter, _ in written(quick, CHAPTERS)}
    left = {"solution_verification", "contact_loss"}
    assert set(ASKED) - keys == left
    assert sentence(quick)
    assert FULL.full
    assert not QUICK.full


def table_of(content, key):
    return next(block for block in content.blocks if getattr(block, "key", None) == key)


@pytest.fixture(scope="module")
def document(computed, chapters):
    by_key = {chapter.key: chapter for chapter in CHAPTERS}
    return document_of(computed, tuple((by_key[key], made) for key, made in chapters.items()), quick=False)


def test_every_number_of_the_page_is_in_the_data(document, chapters):
    # Facts carry numbers in their notes, figures in their captions, tables in their notes.
    told = json.dumps(document, ensure_ascii=False)
    for content in chapters.values():
        for block in content.blocks:
            words = [getattr(block, "caption", ""), getattr(block, "note", "")]
            words += [fact.note for fact in getattr(block, "items", ()) if isinstance(fact, Fact)]
            for text in words:
                assert json.dumps(text, ensure_ascii=False)[1:-1] in told


def failing(check):
    return dataclasses.replace(check, value=2.0 * check.limit + 1.0)


def test_one_failing_refinement_turns_the_chapter(pair):
    studies = refinements(pair, 64)
    levels = tuple(dataclasses.replace(level, error=2 * studies[0].limit) for level in studies[0].levels)
    wrong = dataclasses.replace(studies[0], levels=levels)
    assert solution_verification.content(studies).badge.state == "confirmed"
    assert solution_verification.content((wrong, *studies[1:])).badge.state == "not confirmed"


def test_stored_evidence_says_where_it_is_of_another_source_and_which_kind_fails():
    check = {"subject": "s", "exact": "e", "value": 2.0, "limit": 0.3, "theory": 2.1}
    kinds = [{"key": "k", "title": "orders", "checks": [check, check | {"value": 3.0}]}]
    stored = {"date": "2026-01-01", "source_sha256": "a", "kinds": kinds}
    stored |= {"faults": {"all": 9, "tests": 9}, "sound_pairs": {"agrees": 5}}
    text, table = code_verification.content(stored, "a").blocks
    assert "1 of 2 checks pass. The source of this program is the one that was checked." in text.text
    ((title, count, use, verdict),) = table.rows
    assert (title, count, verdict.state) == ("orders", 2, "outside")
    assert use == pytest.approx(3.0)
    assert "has changed since" in code_verification.content(stored, "b").blocks[0].text


def test_a_failing_check_of_the_models_turns_the_headline(sharing, pair):
    wrong = sharing(pair)
    first, *others = wrong.tooth_stiffness.checks
    wrong.tooth_stiffness = dataclasses.replace(wrong.tooth_stiffness, checks=(failing(first), *others))
    assert stability.answer(wrong).badge.state == "stable"
    told = "Do not rely on this prediction: checks of the models fail (energy_elastic)"
    assert sentence(wrong).startswith(told)


@pytest.fixture
def attributed():
    shape = (len(CAUSES) + 1, 4)
    values = np.arange(1.0, 1.0 + np.prod(shape)).reshape(shape)
    values[0, 2] = np.nan  # y without friction
    return xr.Dataset(
        {"alone": (("cause", "quantity"), values), "without": (("cause", "quantity"), 100.0 * values)},
        coords={"cause": [*CAUSES, "all"], "quantity": ["dte", "x_p", "y_p", "theta_p"]},
        attrs={"largest": "entry_shift", "parts": "entry_shift, sliding_velocity", "contact": "prescribed"},
    )


def test_the_table_has_every_cause_and_its_numbers(attributed):
    text, table = cross_check.causes(attributed)
    assert isinstance(table, Table)
    assert len(table.rows) == len(CAUSES) + 1
    keys = list(table.columns)
    row = dict(zip(keys, table.rows[2], strict=True))
    assert row["dte_alone"] == float(attributed["alone"].sel(cause="entry_shift", quantity="dte"))
    assert row["y_p_without"] == float(attributed["without"].sel(cause="entry_shift", quantity="y_p"))
    assert table.marked == {2}
    assert row["cause"] in text.text
    everything = dict(zip(keys, map(plain, table.rows[-1]), strict=True))
    assert everything["dte_without"] is None  # all but all is the lumped motion: nothing to state
    assert dict(zip(keys, table.rows[0], strict=True))["y_p_alone"] is None
    assert [str(row[0]).endswith("(not part of all)") for row in table.rows[1:4]] == [False, False, True]


def test_a_pair_without_multibody_motion_has_no_causes(check, monkeypatch):
    def fail(*_, **__):
        raise NumericalError("No periodic multibody motion.")

    monkeypatch.setattr(cross_check_words.multibody, "attribution", fail)
    assert cross_check.causes(cross_check_words.attribution(check)) == []


def test_a_bored_body_is_stated_as_a_spring_and_a_solid_one_is_not(sharing):
    bored = lumped.load_gear_pair("nasa_28_28").with_(gear__bore=15.0)
    content = parameters.CHAPTER.write(sharing(bored))
    (spring,) = [f for f in table_of(content, "derived").items if f.key.startswith("body_twist")]
    assert spring.key == "body_twist_gear"
    # 4 pi G b/(1/r_i^2 - 1/r_f^2) with G = 206/2.6 GPa, b = 6.35 mm, r_i = 7.5 mm, r_f = 40.48 mm.
    assert spring.value.value == pytest.approx(3.683e5, rel=1e-3)
    assert "2.11e+08 N/m" in spring.note

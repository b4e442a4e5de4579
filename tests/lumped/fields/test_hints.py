"""Is the advice of the table of hints right: does every field exist, and does every example work?"""

from __future__ import annotations

from collections import Counter

import pytest

from lumped.errors import ParameterError
from lumped.fields.hints import HINTS, Hint, hint_of
from lumped.schema.pair import field_at
from tests.unlike_pairs import unlike_pair
from validation.commands import options


def test_no_word_has_two_rows() -> None:
    assert [word for word, count in Counter(w for one in HINTS for w in one.words).items() if count > 1] == []


@pytest.mark.parametrize("hint", HINTS, ids=[one.words[0] for one in HINTS])
def test_the_fields_exist_and_the_examples_change_them(hint: Hint) -> None:
    for path in hint.fields:
        field_at(path.replace("gears.", "gear."))
    pair = unlike_pair("rack_25_degrees_always_pushing")
    changes = {name: options.value_of(example) for name, example in hint.changes}
    assert pair.with_(changes) != pair
    by_python = eval(f"dict({hint.arguments})")
    assert pair.with_(**by_python) == pair.with_(changes)
    typed = hint.settings.replace("'", "").split("--set ")[1:]
    assert options.set_fields(typed) == dict(hint.changes)


@pytest.mark.parametrize(("word", "section", "paths"), [
    ("quality", "gear.quality", "gear.deviations.tolerance_class"),
    ("quality", "", "pinion.deviations.tolerance_class and gear.deviations.tolerance_class"),
    ("Diametral-Pitch", "pinion", "basic_rack.module"),
])  # fmt: skip
def test_a_gear_that_the_user_names_is_in_the_path(word: str, section: str, paths: str) -> None:
    hint = hint_of(word)
    assert hint is not None
    assert hint.named(section) == paths


def test_a_diametral_pitch_of_five_is_the_module_of_the_example() -> None:
    """Module in mm times teeth an inch is 25.4 (ANSI/AGMA 1012)."""
    hint = hint_of("dp")
    assert hint is not None
    pair = unlike_pair("larger_gear_drives_contact_lost").with_(dict(hint.changes))
    assert pair.basic_rack.module * 5 == pytest.approx(25.4e-3, rel=1e-12)


@pytest.mark.parametrize("word", [word for hint in HINTS for word in hint.words])
def test_every_word_is_answered_by_its_fields(word: str) -> None:
    hint = hint_of(word)
    assert hint is not None
    with pytest.raises(ParameterError) as refused:
        unlike_pair("larger_gear_drives_contact_lost").with_({f"mesh.{word}": 1})
    (problem,) = refused.value.problems
    assert (problem.allowed, problem.action) == (hint.named(), hint.sentence)

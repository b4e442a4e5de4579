"""Do texts and tables of results say what a person needs, with units, on one screen?"""

from __future__ import annotations

import copy
import pickle
import re
from dataclasses import dataclass
from enum import Enum

import numpy as np
import pytest
from matplotlib.figure import Figure

from lumped import optimal_relief
from lumped.display import pictures
from lumped.display.described import description
from lumped.display.result import MOST_ROWS, DisplayedResult, value_text
from lumped.errors import NumericalError, ParameterError, refuse
from lumped.gear_geometry.geometry import Geometry
from tests.unlike_pairs import unlike_pair

NARROW = "\u00a0"


class Kind(Enum):
    PLAIN = "plain"
    WORDS = ("short", "a longer text")


@dataclass(frozen=True, eq=False, repr=False)
class Sample(DisplayedResult):
    """Sizes of a sample [J].

    Attributes
    ----------
    deflection : mean approach of the teeth [m]; NaN: there is none
    share : part that one pair carries [-]
    pinion, gear : number of teeth that drives, and number of teeth that is driven
    work : what is left
    curve : (n,) values over the cycle [N]
    note : remark; empty: there is none
    """

    deflection: float
    share: float
    pinion: int
    gear: int
    work: float
    curve: np.ndarray
    note: str = ""

    @property
    def doubled(self) -> float:
        """Twice the approach, e.g. 1.5 um. A second sentence [N]."""
        return 2.0 * self.deflection

    @property
    def failing(self) -> float:
        """What cannot be computed [m]."""
        raise NumericalError("no answer here")


SAMPLE = Sample(3.2e-6, 0.25, 19, 41, 1500.0, np.linspace(0.0, 5.0, 6))


def lines(result: DisplayedResult) -> dict[str, str]:
    """Name of the attribute -> the rest of its line."""
    return {line.split()[0]: " ".join(line.split()[1:]) for line in repr(result).splitlines()[1:]}


def test_words_and_units_are_those_of_the_docstrings() -> None:
    assert description(Sample, "deflection") == ("mean approach of the teeth", "m")
    assert description(Sample, "share") == ("part that one pair carries", "1")
    assert description(Sample, "gear") == ("number of teeth that is driven", "J")
    assert description(Sample, "work") == ("what is left", "J")  # the unit of the whole class
    assert description(Sample, "doubled") == ("twice the approach, e.g. 1.5 um", "")
    assert description(Sample, "curve") == ("values over the cycle", "N")
    assert description(Sample, "absent") == ("", "")
    assert description(Geometry, "base_radius_gear") == ("r_bg", "m")


def test_a_line_has_name_value_unit_and_meaning() -> None:
    shown = lines(SAMPLE)
    assert shown["deflection"] == "3.2 µm mean approach of the teeth"
    assert shown["work"].startswith("1500 J")
    assert shown["curve"] == "0, 1 N, 2 N, 3 N, ... (6) values over the cycle"
    assert "note" not in shown  # a line without a value is left out
    assert repr(SAMPLE).splitlines()[-1] == "  and: doubled, failing, plot>"


@pytest.mark.parametrize(("value", "text"), [
    (None, "none"), (True, "yes"), (np.bool_(False), "no"), (7, "7"), (Kind.PLAIN, "plain"),
    (Kind.WORDS, "short"), ((), "none"), (np.zeros((2, 3)), "array (2, 3)"), ({"a": 1.0}, "a: 1"),
    (SAMPLE, "Sample"), ((SAMPLE, SAMPLE), "2 of Sample"), (1.5 - 2j, "1.5 \u2212 2j"), ("words", "words"),
])  # fmt: skip
def test_values_of_every_kind(value: object, text: str) -> None:
    assert value_text(value) == text


def test_what_cannot_be_computed_is_said_and_breaks_no_table() -> None:
    class Other(Sample):
        shown = ("share", "failing")

    other = Other(*SAMPLE.__dict__.values())
    assert lines(other)["failing"].startswith("not available: no answer here")
    assert "no answer here" in other._repr_html_()


def test_no_table_is_longer_than_a_screen() -> None:
    class Long(Sample):
        shown = ("share",) * 40

    text = repr(Long(*SAMPLE.__dict__.values()))
    assert len(text.splitlines()) == MOST_ROWS + 2 <= 20
    assert max(map(len, text.splitlines())) <= 111


def test_html_escapes_texts_and_has_every_row() -> None:
    page = Sample(3.2e-6, 0.25, 19, 41, 1.0, np.ones(2), note="<script>a & b</script>")._repr_html_()
    assert "<script>" not in page
    assert "&lt;script&gt;a &amp; b" in page
    assert len(re.findall("<tr>", page)) == 7
    assert f"3.2{NARROW}µm" in page


def test_the_picture_is_of_the_function_that_was_handed_down(monkeypatch: pytest.MonkeyPatch) -> None:
    def draw(result: object) -> Figure:
        if not isinstance(result, Sample):
            raise refuse("result", "no sample", "a sample", "Give one.")
        figure = Figure()
        figure.add_subplot().set(xlabel="time [s]", ylabel="load [N]")
        return figure

    monkeypatch.setattr(pictures, "_drawing", [draw])
    relief = optimal_relief(unlike_pair("contact_ratio_1_1_large_shifts"))
    assert "data:image/png;base64,iVBOR" in SAMPLE._repr_html_()
    assert "<img" not in relief._repr_html_()
    with pytest.raises(ParameterError, match="no sample"):
        relief.plot()
    monkeypatch.setattr(pictures, "_drawing", [])
    assert "<img" not in SAMPLE._repr_html_()
    with pytest.raises(ParameterError, match="Write import spurcheck first"):
        SAMPLE.plot()


def test_an_unknown_name_gets_advice() -> None:
    class Advising(Sample):
        instead = {"save": "write_results(...)"}  # noqa: RUF012

    advising = Advising(*SAMPLE.__dict__.values())
    for name, words in (
        ("save", "use write_results"),
        ("deflections", "Did you mean 'deflection'"),
        ("zzz", "It has deflection, share"),
    ):
        with pytest.raises(AttributeError, match=re.escape(words)):
            getattr(advising, name)
    geometry = unlike_pair("larger_gear_drives_contact_lost").geometry
    with pytest.raises(AttributeError, match="base_radius_pinion' or 'base_radius_gear"):
        _ = geometry.base_radius


def test_copies_and_pickles_are_as_before() -> None:
    for other in (copy.copy(SAMPLE), copy.deepcopy(SAMPLE), pickle.loads(pickle.dumps(SAMPLE))):
        assert repr(other) == repr(SAMPLE)

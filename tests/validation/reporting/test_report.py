"""Is the report complete, true to its JSON, the same every time, safe to open, and written whole?"""

import json
import re
from collections import defaultdict
from html.parser import HTMLParser

import pytest

import lumped
from lumped import ParameterError
from validation import reporting
from validation.files.folder import whole_folder
from validation.reporting import build
from validation.reporting.blocks import Answer, Badge, Content, Fact, Facts, Picture, Quantity, Table
from validation.reporting.chapter import Chapter
from validation.reporting.page import render

HOSTILE = '<script>alert("x")</script> & "Getriebe" \'1\''


@pytest.fixture(scope="module")
def hostile(pair):
    return pair.with_({"name": HOSTILE, "description": HOSTILE, "sources": {"mesh": HOSTILE}})


@pytest.fixture(scope="module")
def written(hostile, sharing, tmp_path_factory):
    """A report whose long results are those of another one of the same numbers, computed long before."""
    out = tmp_path_factory.mktemp("reports") / "new" / "report"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(build, "Results", lambda pair, _: sharing(pair))
        return reporting.report(hostile, out, quick=True)


def _data(folder):
    return json.loads((folder / "report.json").read_text(encoding="utf-8"))


class _Page(HTMLParser):
    """Tags, attributes and text of a page."""

    def __init__(self, text):
        super().__init__()
        self.tags, self.links, self.text, self.ids = [], [], [], set()
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        found = dict(attrs)
        self.links += [found[k] for k in ("src", "href") if k in found]
        self.ids.add(found.get("id"))

    def handle_data(self, data):
        self.text.append(data)


@pytest.fixture(scope="module")
def page(written):
    return _Page((written.folder / "index.html").read_text(encoding="utf-8"))


def test_the_folder_holds_page_numbers_figures_and_data(written):
    names = {str(p.relative_to(written.folder)) for p in written.folder.rglob("*") if p.is_file()}
    assert {"index.html", "report.json", "data/parameters.toml", "data/stability_chart.nc"} <= names
    data = _data(written.folder)
    figures = [key for chapter in data["chapters"].values() for key in chapter.get("figures", [])]
    assert len(figures) >= 12
    assert {f"figures/{key}.svg" for key in ("answer", *figures)} <= names


def test_the_parameter_file_in_the_folder_reproduces_the_pair(written, hostile):
    assert lumped.load_gear_pair(written.folder / "data" / "parameters.toml") == hostile


def test_the_page_needs_neither_network_nor_scripts(page, written):
    assert "script" not in page.tags
    assert "link" not in page.tags
    others = [link for link in page.links if not link.startswith(("#", "data:"))]
    assert others == []
    assert all(link[1:] in page.ids for link in page.links if link.startswith("#"))


def test_hostile_names_are_text(page, written):
    assert HOSTILE in "".join(page.text)
    assert "<script" not in (written.folder / "index.html").read_text(encoding="utf-8")


def test_report_json_is_strict_and_says_what_the_page_says(written, page, hostile):
    def refuse(constant):
        raise AssertionError(constant)

    data = json.loads((written.folder / "report.json").read_text(encoding="utf-8"), parse_constant=refuse)
    assert data["verdict"] == written.sentence
    text = "".join(page.text)
    assert data["headline"] in text
    # The paper's contact is a third of the peak to peak off: the first words and the last answer both say so.
    assert "their contact is too simple" in data["headline"]
    assert "the contact follows the load (it does not)" in data["answers"][-1]["text"]
    assert data["answers"][-1]["verdict"]["state"] == "warning"
    for answer in data["answers"]:
        assert answer["text"] in text
        assert answer["text"] in data["verdict"]
    for chapter in data["chapters"].values():
        assert chapter["title"] in text
    steady = data["chapters"]["steady_state"]["key_results"]
    shown = float(
        re.search(r"([\d.]+)\s*µm", text[text.index("transmission error, peak to peak") :]).group(1)
    )
    # Four digits are shown.
    assert shown == pytest.approx(1e6 * steady["dte_peak_to_peak"]["value"]["value"], rel=1e-3)
    # The paper's brake pays for sliding alone, but the efficiency that is told leaves no loss out.
    attrs = lumped.steady_state(hostile).attrs
    driving = attrs["pinion_torque"] * hostile.operating.pinion_speed
    every_loss = attrs["mesh_efficiency"] - attrs["power_energy_residual"] / driving
    assert steady["total_efficiency"]["value"] == pytest.approx(every_loss, abs=1e-8)


@pytest.fixture(scope="module")
def again(written, hostile, tmp_path_factory):
    """The same report, compared with the first one after one number of that was changed by a percent."""
    earlier = _data(written.folder)
    earlier["chapters"]["steady_state"]["key_results"]["dte_peak_to_peak"]["value"]["value"] *= 1.01
    folder = tmp_path_factory.mktemp("again")
    (folder / "earlier.json").write_text(json.dumps(earlier))
    told = []
    draw, places = build._draw, ("answer", "path_of_contact", "motions", "sliding_power")

    def some(pictures, *rest):
        return defaultdict(str, draw(tuple(p for p in pictures if p.key in places), *rest))

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(build, "_draw", some)  # every kind of figure is drawn by the same style
        made = reporting.report(
            hostile,
            folder / "report",
            quick=True,
            compare=folder / "earlier.json",
            progress=lambda fraction, stage="", /: told.append((fraction, stage)),
        )
    return made, told


def test_same_parameters_same_bytes_apart_from_the_timestamps(written, again):
    first, second = _data(written.folder), _data(again[0].folder)
    assert first.pop("timestamps").keys() == second.pop("timestamps").keys()
    assert json.dumps(first) == json.dumps(second)
    pictures = sorted((again[0].folder / "figures").glob("*.svg"))
    assert len(pictures) >= 4
    for path in pictures:
        assert path.read_bytes() == (written.folder / "figures" / path.name).read_bytes(), path.name


def test_a_change_past_its_tolerance_is_found(again):
    (change,) = again[0].comparison.regressions
    assert change.path == "steady_state/key_results/dte_peak_to_peak"


def test_progress_goes_forward_and_names_what_is_done(again):
    fractions, stages = zip(*again[1], strict=True)
    assert list(fractions) == sorted(fractions)
    assert fractions[-1] == 1.0
    assert {"periodic motion", "stability chart", "figures"} <= set(stages)


def test_a_stable_report_warns_of_nothing(written):
    text = (written.folder / "index.html").read_text(encoding="utf-8")
    assert "Warning" not in re.sub(r"data:image[^\"]*", "", text)
    data = _data(written.folder)
    assert data["answers"][0]["verdict"]["state"] == "prediction"
    assert data["chapters"]["steady_state"]["over_speed"]["share_unstable"]["value"] == 0.0


def test_a_failure_midway_leaves_nothing_behind(pair, tmp_path, monkeypatch):
    def fail(_, folder, __):
        folder.mkdir()
        (folder / "half.png").write_bytes(b"half")
        raise RuntimeError("midway")

    monkeypatch.setattr(build, "written", lambda *_, **__: ())
    monkeypatch.setattr(build, "_draw", fail)
    with pytest.raises(RuntimeError, match="midway"):
        reporting.report(pair, tmp_path / "deep" / "report", quick=True)
    assert list(tmp_path.iterdir()) == []


def test_a_failed_replacement_keeps_the_earlier_report(pair, tmp_path, monkeypatch):
    out = tmp_path / "report"
    with whole_folder(out, force=False) as folder:
        (folder / "report.json").write_text("{}")
    earlier = sorted(p.name for p in out.iterdir())

    def interrupt(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr(build, "written", interrupt)
    with pytest.raises(KeyboardInterrupt):
        reporting.report(pair, out, quick=True, force=True)
    assert [p.name for p in tmp_path.iterdir()] == ["report"]
    assert sorted(p.name for p in out.iterdir()) == earlier


def test_the_report_refuses_its_folder_and_its_baseline_before_work(pair, tmp_path, monkeypatch):
    def no_work(*_, **__):
        raise AssertionError("work was done")

    monkeypatch.setattr(build, "written", no_work)
    (tmp_path / "notes.txt").write_text("mine")
    with pytest.raises(ParameterError, match="--force"):
        reporting.report(pair, tmp_path, quick=True)
    with pytest.raises(ParameterError, match="--compare"):
        reporting.report(pair, tmp_path / "new", quick=True, compare=tmp_path / "none.json")
    assert [p.name for p in tmp_path.iterdir()] == ["notes.txt"]


def test_numbers_stand_to_the_right_under_their_heading_gaps_included(pair):
    table = Table(
        "t",
        "caption",
        {"a": "A", "b": "B"},
        (("x", None), ("y", Quantity(1.0, "m")), ("z", 2.0)),
    )
    facts = Facts("f", (Fact("h", "hash", "0" * 64), Fact("w", "word", "ok")))
    made = (Chapter("c", "C", lambda _: None), Content((table, facts)))
    timestamps = {"created": "2020-01-01", "seconds": {"all": 1.0}}
    data = {"quick": False, "headline": "It holds.", "doubts": ["Is it 5?"], "timestamps": timestamps}
    answers = {"c": Answer("Is it good?", Badge("ok"), "Yes.")}
    text = render(pair, Picture("f", "", lambda: None), answers, (made,), {"f": ""}, data)
    assert re.findall(r"<th scope=\"col\"([^>]*)>", text) == ["", ' class="number"']
    assert text.count('<td class="number">') == 3
    assert text.count('<div class="long">') == 1
    assert '<p class="verdict fair">' in text  # a doubt on a given value stands under the first words
    assert "<li>Is it 5?</li>" in text

"""Is the report complete, true to its JSON, the same every time, safe to open, and written whole?"""

import dataclasses
import importlib
import json
import re
from html.parser import HTMLParser

import pytest

import lumped
from lumped import ParameterError
from validation import reporting
from validation.reporting import build, results
from validation.reporting.blocks import Chapter, Fact, Facts, Quantity, Table
from validation.reporting.page import render
from validation.reporting.verdict import Summary

#: The module: the package has the chapter's function under the same name.
provenance = importlib.import_module("validation.reporting.chapters.provenance")

HOSTILE = '<script>alert("x")</script> & "Getriebe" \'1\''


@pytest.fixture(scope="module", autouse=True)
def tiny():
    """The quick report on even fewer points: these tests look at the folder, not at the physics."""
    effort = dataclasses.replace(
        results.QUICK, samples=64, cycles=6, sweep_speeds=4, chart_speeds=4, chart_dampings=2, chart_rtol=1e-6
    )
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(build, "QUICK", effort)
        yield


@pytest.fixture(scope="module")
def hostile(pair):
    return pair.with_({"name": HOSTILE, "description": HOSTILE, "sources": {"mesh": HOSTILE}})


@pytest.fixture(scope="module")
def written(hostile, tmp_path_factory):
    out = tmp_path_factory.mktemp("reports") / "new" / "report"
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
    assert {f"figures/{key}{suffix}" for key in figures for suffix in (".png", ".svg")} <= names


def test_the_parameter_file_in_the_folder_reproduces_the_pair(written, hostile):
    assert lumped.load_gear_pair(written.folder / "data" / "parameters.toml") == hostile


def test_the_page_needs_neither_network_nor_scripts(page, written):
    assert "script" not in page.tags
    assert "link" not in page.tags
    others = [link for link in page.links if not link.startswith(("#", "data:"))]
    assert others == ["interactive.html"]
    assert (written.folder / "interactive.html").is_file()
    assert (written.folder / "data" / "interactive.nc").is_file()
    assert all(link[1:] in page.ids for link in page.links if link.startswith("#"))


def test_hostile_names_are_text(page, written):
    assert HOSTILE in "".join(page.text)
    assert "<script" not in (written.folder / "index.html").read_text(encoding="utf-8")


def test_report_json_is_strict_and_says_what_the_page_says(written, page):
    def refuse(constant):
        raise AssertionError(constant)

    data = json.loads((written.folder / "report.json").read_text(encoding="utf-8"), parse_constant=refuse)
    assert data["verdict"] == written.sentence
    text = "".join(page.text)
    assert data["verdict"] in text
    for chapter in data["chapters"].values():
        assert chapter["title"] in text
    steady = data["chapters"]["steady_state"]["key_results"]
    shown = float(
        re.search(r"([\d.]+)\s*µm", text[text.index("transmission error, peak to peak") :]).group(1)
    )
    # Four digits are shown.
    assert shown == pytest.approx(1e6 * steady["dte_peak_to_peak"]["value"]["value"], rel=1e-3)


def test_same_parameters_same_bytes_apart_from_the_timestamps(written, hostile, tmp_path):
    again = reporting.report(hostile, tmp_path / "again", quick=True)
    first, second = _data(written.folder), _data(again.folder)
    assert first.pop("timestamps").keys() == second.pop("timestamps").keys()
    assert json.dumps(first) == json.dumps(second)
    for path in sorted((written.folder / "figures").iterdir()):
        assert path.read_bytes() == (again.folder / "figures" / path.name).read_bytes(), path.name


def test_a_failure_midway_leaves_nothing_behind(pair, tmp_path, monkeypatch):
    def fail(_, folder, __):
        folder.mkdir()
        (folder / "half.png").write_bytes(b"half")
        raise RuntimeError("midway")

    monkeypatch.setattr(build, "_draw", fail)
    with pytest.raises(RuntimeError, match="midway"):
        reporting.report(pair, tmp_path / "deep" / "report", quick=True)
    assert list(tmp_path.iterdir()) == []


def test_a_failed_replacement_keeps_the_earlier_report(pair, tmp_path, monkeypatch):
    out = tmp_path / "report"
    out.mkdir()
    (out / "report.json").write_text(json.dumps({"format": "spurcheck-report"}))

    def interrupt(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(build, "compute", interrupt)
    with pytest.raises(KeyboardInterrupt):
        reporting.report(pair, out, quick=True, force=True)
    assert [p.name for p in tmp_path.iterdir()] == ["report"]
    assert [p.name for p in out.iterdir()] == ["report.json"]


def test_values_without_a_source_count_as_assumed(pair):
    from validation.reporting.chapters.parameters import is_assumed, source_of

    assert is_assumed(source_of(pair, "bearings.pinion.loa_stiffness"))  # from the section's own entry
    assert is_assumed(source_of(pair, "basic_rack.addendum_coefficient"))  # no entry at all
    assert not is_assumed(source_of(pair, "pinion.teeth"))


def test_the_report_asks_before_work_whether_it_may_write(pair, tmp_path, monkeypatch):
    def no_work(*_):
        raise AssertionError("work was done")

    monkeypatch.setattr(build, "compute", no_work)
    (tmp_path / "notes.txt").write_text("mine")
    with pytest.raises(ParameterError, match="--force"):
        reporting.report(pair, tmp_path, quick=True)


def test_the_headline_states_the_largest_difference_also_when_it_is_within_its_tolerance(check):
    from validation.reporting.verdict import finite_motions

    def widened(left, pinion=0.3):
        apart = {"y_g": 0.4, "y_p": pinion}
        return dataclasses.replace(
            check,
            agreements=tuple(
                dataclasses.replace(
                    a,
                    relative_l2=apart.get(a.quantity, 0.3) if a.fidelity == "exact" else 0.3,
                    remainder_l2=left if (a.quantity, a.fidelity) == ("x_p", "exact") else 0.05,
                    tolerance=dataclasses.replace(a.tolerance, limit=1.0),
                )
                for a in check.agreements
            ),
        )

    assert widened(0.07).verdict == "confirmed"
    text = finite_motions(widened(0.07)).replace("\u00a0", " ")
    assert "changes the transmission error by 30 % and gear y, most of all, by 40 %" in text
    assert text.endswith("the lumped motion alone accounts for all but 7 % (tolerance 100 %).")
    # Equal but for rounding, as the bodies of a 1:1 pair are: the first is named, whichever is larger.
    for pinion in (0.4 - 1e-12, 0.4 + 1e-12):
        assert "and pinion y, most of all" in finite_motions(widened(0.07, pinion)).replace("\u00a0", " ")
    # More than half is left: that is no account.
    text = finite_motions(widened(0.2)).replace("\u00a0", " ")
    assert text.endswith("does not account for this (20 % left, tolerance 100 %).")


def test_numbers_stand_to_the_right_under_their_heading_gaps_included(pair):
    table = Table(
        "t",
        "caption",
        {"a": "A", "b": "B"},
        (("x", None), ("y", Quantity(1.0, "m")), ("z", 2.0)),
    )
    chapter = Chapter("c", "C", (table, Facts("f", (Fact("h", "hash", "0" * 64), Fact("w", "word", "ok")))))
    timestamps = {"created": "2020-01-01", "seconds": {"all": 1.0}}
    data = {"quick": False, "interactive_page": None, "timestamps": timestamps}
    text = render(pair, Summary("It holds.", ()), (chapter,), {}, data)
    assert re.findall(r"<th scope=\"col\"([^>]*)>", text) == ["", ' class="number"']
    assert text.count('<td class="number">') == 3
    assert text.count('<div class="long">') == 1


def test_the_source_hash_sees_every_package(tmp_path, monkeypatch):
    roots = {}
    for package in provenance._OWN:
        roots[package] = tmp_path / package
        roots[package].mkdir()
        (roots[package] / "a.py").write_text("x = 1")
    monkeypatch.setattr(provenance.resources, "files", lambda name: roots[name])
    first = provenance.source_hash.__wrapped__()
    assert len(first) == 64
    assert provenance.source_hash.__wrapped__() == first
    for package in provenance._OWN:
        (roots[package] / "a.py").write_text("x = 2")
        assert provenance.source_hash.__wrapped__() != first
        (roots[package] / "a.py").write_text("x = 1")
    (roots["lumped"] / "a.py").rename(roots["lumped"] / "b.py")
    assert provenance.source_hash.__wrapped__() != first

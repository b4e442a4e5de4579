"""Are the page's numbers those of the models, is its file whole and closed, and is refused what cannot be?"""

import base64
import dataclasses
import hashlib
import inspect
import json
import re
from html.parser import HTMLParser

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import lumped
from floquet.gear.axes import vary
from floquet.gear.chart import stability_chart
from floquet.gear.multipliers import gear_pair_multipliers
from tests.validation.commands.conftest import run
from validation.interactive import page
from validation.interactive.payload import payload, script_json
from validation.interactive.results import Sampling, compute
from validation.validity.flags import contact_loss, sliding_reversal

TINY = Sampling(speeds=5, dampings=3, slices=2, sweep_speeds=4)


class _Page(HTMLParser):
    """Tags with their attributes, and the content of script elements."""

    def __init__(self, text):
        super().__init__()
        self.tags = []
        self.scripts = []
        self.inside = False
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))
        self.inside = tag == "script"
        if self.inside:
            self.scripts.append("")

    def handle_endtag(self, tag):
        self.inside = False

    def handle_data(self, data):
        if self.inside:
            self.scripts[-1] += data


@pytest.fixture(scope="session")
def text(written):
    return written.read_text(encoding="utf-8")


@pytest.fixture(scope="session")
def results(pair):
    return compute(pair, TINY)


def test_the_charts_are_those_of_the_general_engine(data, pair):
    """The chart comes from the compiled kernel; the propagation it is held against shares no code."""
    stiffnesses = {
        f"bearings.{g}.{d}_stiffness": getattr(getattr(pair.bearings, g), f"{d}_stiffness")
        for g in ("pinion", "gear")
        for d in ("loa", "oloa")
    }
    for k, i, j in ((0, 0, 30), (2, 3, 11), (1, 5, 4)):
        point = {"speed_rpm": float(data["speed_rpm"][j]), "damping_ratio": float(data["damping_ratio"][i])}
        factor = float(data["bearing_factor"][k])
        stiffer = pair.with_({path: factor * value for path, value in stiffnesses.items()})
        expected = gear_pair_multipliers(vary(stiffer, point), 1e-9, method="gauss").spectral_radius
        spectral_radius = data["spectral_radius_over_bearing_factor"][k, i, j]
        assert float(spectral_radius) == pytest.approx(expected, abs=1e-6)  # the page shows six decimals
        mean = float(data["friction_coefficient"][k])
        rubbing = vary(pair, point | {"friction_coefficient": mean})
        expected = gear_pair_multipliers(rubbing, 1e-9, method="gauss").spectral_radius
        spectral_radius = data["spectral_radius_over_friction_coefficient"][k, i, j]
        assert float(spectral_radius) == pytest.approx(expected, abs=1e-6)


def test_the_pair_itself_is_on_every_chart(data, pair, results):
    axes = {"speed_rpm": [4875.0], "damping_ratio": [0.016]}
    expected = float(stability_chart(pair, axes)["spectral_radius"].squeeze())
    assert results.multipliers.spectral_radius == pytest.approx(expected, abs=1e-9)
    for key, slices in results.stability.items():
        nearest = slices.chart.isel({key: slices.index_of_pair}).sel(speed_rpm=4875.0, damping_ratio=0.016)
        assert float(nearest["spectral_radius"]) == pytest.approx(expected, abs=1e-6), key


def test_the_responses_are_those_of_the_models(data, pair):
    for law in ("none", "coulomb", "xu_kahraman"):
        for j in (0, 5):
            rpm = float(data["speed"][j])
            running = pair.with_({"friction.law": law, "operating.pinion_speed": rpm})
            motion = lumped.steady_state(running, samples_per_cycle=96)
            one = data.sel(law=law).isel(speed=j)
            # The speed passes from rpm to rad/s and back, and peaks are differences of larger numbers.
            for name, variable in (("dte", "dte_peak_to_peak"), ("y_p", "y_p_peak_to_peak")):
                expected = motion.attrs[f"{name}_peak_to_peak"]
                scale = float(np.abs(motion[name]).max())
                assert float(one[variable]) == pytest.approx(expected, abs=1e-9 * scale)
            g = running.geometry
            torque = running.operating.pinion_torque
            contact = contact_loss(running, g, motion)
            sliding = sliding_reversal(g, motion)
            lowest = contact.value * g.base_radius_pinion / torque
            assert float(one["lowest_load"]) == pytest.approx(lowest, rel=1e-8)
            assert float(one["reversal"]) == pytest.approx(sliding.value / g.base_pitch, rel=1e-8, abs=1e-12)
            states = ["ok", "warning", "violated"]
            assert int(one["validity"]) == max(states.index(flag.state) for flag in (contact, sliding))


def test_every_variable_of_the_data_file_has_a_unit_and_a_name(data):
    for name in data.variables:
        assert data[name].attrs["long_name"], name
        assert name == "law" or data[name].attrs["units"], name
    assert data.attrs["gear_pair"] == "nasa_28_28"


def test_the_page_is_small_closed_and_names_its_scripts_by_hash(written, text):
    assert written.stat().st_size < 6e6
    page = _Page(text)
    assert not any({"src", "srcset"} & set(attrs) for _, attrs in page.tags)
    links = [attrs["href"] for _, attrs in page.tags if "href" in attrs]
    assert links == ["#stability"]
    policy = next(attrs["content"] for _, attrs in page.tags if attrs.get("http-equiv"))
    rules = dict(rule.strip().split(" ", 1) for rule in policy.split(";"))
    assert rules["default-src"] == rules["connect-src"] == "'none'"
    assert "unsafe" not in rules["script-src"]
    digests = [hashlib.sha256(script.encode()).digest() for script in page.scripts[1:]]
    assert rules["script-src"].split() == [f"'sha256-{base64.b64encode(d).decode()}'" for d in digests]
    assert json.loads(page.scripts[0])["point"] == {"speed": 4875.0, "damping": 0.016}
    assert "noscript" in {tag for tag, _ in page.tags}  # says where the numbers are


def test_a_script_that_could_end_its_element_is_not_written(results, monkeypatch):
    monkeypatch.setattr(page, "plotly", lambda: "'</SCRIPT>'")
    with pytest.raises(ValueError, match="end its element"):
        page.render(results, "x.nc")


@given(st.recursive(st.text(), lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner)))
def test_json_in_the_page_opens_nothing_and_reads_back(value):
    text = script_json(value)
    assert re.search(r"[<>&\u2028\u2029]", text) is None
    assert json.loads(text) == value


def test_a_speed_without_periodic_motion_is_a_gap(results):
    """NaN is no JSON: the page has null there."""
    sweep = results.sweep.copy(deep=True)
    for name in ("dte_peak_to_peak", "y_p_peak_to_peak", "lowest_load", "reversal", "spectral_radius"):
        sweep[name][:, 1] = np.nan
    sweep["validity"][:, 1] = 3
    gap = dataclasses.replace(results, sweep=sweep)
    law = payload(gap)["sweep"]["laws"][0]
    assert law["dte"][1] is None
    assert law["dte"][2] is not None
    text = page.render(gap, "x.nc")
    assert "NaN" not in _Page(text).scripts[0]


def test_a_law_that_the_pair_does_not_admit_is_named(pair):
    """Law II has no value from a roughness of 1.13 um on."""
    rough = pair.with_({"pinion.roughness": 1.2, "gear.roughness": 1.2})
    results = compute(rough, TINY)
    assert "benedict_kelley" in results.missing
    assert "benedict_kelley" not in results.sweep["law"]
    assert str(results.sweep["law"].values[results.own_law]) == "xu_kahraman"
    assert "Not available for this pair: II Benedict-Kelley" in page.render(results, "x.nc")


def test_the_same_pair_gives_the_same_page(pair, results):
    assert page.render(compute(pair, TINY), "x.nc") == page.render(results, "x.nc")


@pytest.fixture
def tiny(monkeypatch):
    """Coarse pages: these tests look at files, not at numbers."""
    monkeypatch.setattr(
        inspect.unwrap(page.write_interactive_page), "__kwdefaults__", _defaults(sampling=TINY)
    )


def _defaults(**changes):
    return inspect.unwrap(page.write_interactive_page).__kwdefaults__ | changes


def test_the_command_writes_page_and_data_and_does_not_overwrite(tiny, tmp_path):
    out = tmp_path / "page.html"
    done = run("interactive", "nasa_28_28", "-o", out)
    assert done.exit_code == 0, done.output
    assert sorted(p.name for p in tmp_path.iterdir()) == ["page.html", "page.nc"]
    again = run("interactive", "nasa_28_28", "-o", out)
    assert again.exit_code == 2
    assert "--force" in again.output
    out.unlink()
    assert run("interactive", "nasa_28_28", "-o", out).exit_code == 2  # the data file would be lost
    assert not out.exists()
    assert run("interactive", "nasa_28_28", "-o", out, "--force").exit_code == 0

"""Do the numbers on Vaishya and Singh mean what their definitions say, and do verdicts follow from them?"""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import floquet
import lumped
from reproductions.vaishya_singh_2001 import numbers
from reproductions.vaishya_singh_2001.gears import MU, PAIRS, Gears, model_of
from reproductions.vaishya_singh_2001.judge import RULES, statements
from reproductions.vaishya_singh_2001.plots import DRAW
from validation.plots.style import save

FOLDER = Path(numbers.__file__).parent


@pytest.fixture(scope="module")
def table():
    return statements()


def test_verdicts_are_those_of_the_page(table):
    rows = re.findall(
        r"^\| (.+?) \| (.+?) \| (.+?) \| (.+?) \| (.+?) \|$", (FOLDER / "README.md").read_text("utf-8"), re.M
    )
    shown = {row[0]: row[1:] for row in rows if row[0] != "statement or question" and "---" not in row[0]}
    assert list(shown) == [one.rule.text for one in table]
    for one in table:
        *values, verdict = shown[one.rule.text]
        assert verdict == one.verdict
        for name, text in zip(PAIRS, values, strict=True):
            if abs(one.values[name]) > 1e-9:  # smaller ones are rounding
                number = float(text.split()[0])
                assert number == pytest.approx(one.values[name], rel=0.051), one.rule.name


def test_every_rule_has_a_source_and_a_number_of_its_own():
    assert {rule.source for rule in RULES} == {
        "J. Sound Vib. 243, abstract", "J. Sound Vib. 248, abstract", "question of this project",
    }  # fmt: skip
    assert all("abstract" in rule.source for rule in RULES if rule.kind == "statement")
    assert len({rule.number for rule in RULES}) == len(RULES) == len(numbers.NUMBERS)


@pytest.mark.parametrize("rule", RULES, ids=lambda rule: rule.number)
def test_a_criterion_can_fail(rule):
    """Far on the other side of each limit the verdict turns, for one pair that differs from the others."""
    inside = dict.fromkeys(PAIRS, 0.0)
    for test, limit in rule.limits.items():
        step = max(abs(limit), 1.0)
        inside |= dict.fromkeys(PAIRS, limit + (step if test in ("at_least", "above") else -step) * 1e-6)
    assert rule.verdict(inside) in ("reproduced", "answered")
    for test, limit in rule.limits.items():
        outside = limit + (-1.0 if test in ("at_least", "above") else 1.0) * max(abs(limit), 1.0)
        assert rule.verdict(inside | {"fzg_c": outside}) in ("not reproduced", "no common answer")


@pytest.mark.parametrize("name", ["nasa_art_25_31", "fzg_c"])
def test_edges_of_a_zone_are_where_a_multiplier_is_one(name):
    gears = Gears(name)
    zone = gears.zone(2, MU)
    for edge in (zone.low, zone.high):
        pair = model_of(name).pair.with_(speed=gears.speed_rpm(edge))  # order 2: the natural frequency
        trace = floquet.single_degree(pair, stiffness="rectangular").closed_form().monodromy_matrix.trace()
        assert abs(trace) == pytest.approx(2.0, abs=1e-4)  # a straight line between nodes


def test_friction_alone_is_what_friction_adds():
    """Superposition: the motion by both forces less that by the mean force."""
    gears = Gears("fzg_c")
    segments = gears.at_ratio(0.37).closed_form(friction_load="mean")
    lengths = np.diff(segments.edges)
    mean = np.full(
        lengths.size, lengths @ (segments.force_start + segments.force_end) / 2.0 / segments.period
    )
    smooth = replace(segments, force_start=mean, force_end=mean)
    time = segments.period * np.arange(1024) / 1024
    added = segments.motion(time).dte - smooth.motion(time).dte
    share = np.ptp(added) / segments.motion(time).dte.mean()
    assert numbers.friction_alone(gears) == pytest.approx(share, rel=1e-9)


@pytest.mark.parametrize("name", PAIRS)
def test_recess_over_approach_is_by_the_arm_at_the_pitch_point(name):
    g = lumped.load_gear_pair(name).geometry
    model = model_of(name)
    b = lumped.bodies(model.pair)
    arm = model.mass * (
        g.base_radius_pinion * g.L_XP / b.inertia_pinion
        + g.base_radius_gear * (g.L_XY - g.L_XP) / b.inertia_gear
    )
    expected = (1.0 + MU * arm) / (1.0 - MU * arm)
    assert numbers.approach_and_recess(Gears(name)) == pytest.approx(expected, rel=1e-5)


def test_a_truncated_series_converges_to_the_exact_multiplier(monkeypatch):
    gears = Gears("nasa_art_25_31")
    errors = []
    for harmonics in (3, 48):
        monkeypatch.setattr(numbers, "_HARMONICS", harmonics)
        errors.append(numbers.truncation(gears))
    assert errors[1] < 1e-3 * errors[0]


def test_pictures_are_drawn(tmp_path):
    for name, draw in DRAW.items():
        save(draw(), tmp_path / f"{name}.svg")

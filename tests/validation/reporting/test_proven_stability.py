"""Does page 1 name the nearest unstable speed, what is proven, and what was not searched?"""

import math
from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr

from floquet.gear.jump_search import JumpSearch
from floquet.gear.nearest_unstable import StabilityOverSpeed
from lumped import load_gear_pair
from tests.validation.reporting.test_words import plain
from validation.reporting.effort import QUICK
from validation.reporting.facts import instability, proof_words
from validation.reporting.hazards import nearest_of
from validation.reporting.results import Results

LIGHT = {
    "mesh.damping_ratio": 0.0043,
    **{f"bearings.{g}.{line}_damping_ratio": 0.002 for g in ("pinion", "gear") for line in ("loa", "oloa")},
    "mesh.contact": "prescribed",
    "mesh.relief": "ignored",
    "operating.pinion_speed": 3157.87,
}


def results_with(proven: StabilityOverSpeed, unstable_nodes=()) -> Results:
    """Results of a pair whose proof and stability chart are given."""
    results = Results(load_gear_pair("nasa_28_28").at_speed(22.0), QUICK)
    speeds = np.arange(10.0, 61.0, 2.0)
    verdict = np.where(np.isin(speeds, unstable_nodes), -1, 1)[:, None]
    chart = xr.Dataset(
        {"verdict": (("speed_rpm", "damping_ratio"), verdict)},
        {"speed_rpm": speeds, "damping_ratio": [results.pair.mesh.damping_ratio]},
    )
    vars(results).update(proven_stability=proven, chart=chart)
    return results


def of_verdicts(*verdicts: int) -> StabilityOverSpeed:
    """Intervals of 1, 2, 3 ... rpm from 10 rpm, operating speed 22 rpm, to be searched from 10 to 46 rpm."""
    ends = 10.0 + np.cumsum(np.arange(len(verdicts) + 1))
    return StabilityOverSpeed(22.0, (10.0, 46.0), ends[:-1], ends[1:], np.array(verdicts))


@pytest.mark.parametrize(
    ("verdicts", "words"),
    [
        ((1, 1, 1, 1, 1, 1, 1, 1), "the linear motion is proven stable from 10 to 46 rpm"),
        ((1, 1, 1, 1, 1, 1, 1, -1), "the linear motion is proven stable from 10 to 38 rpm"),
        ((1, 0, 0, 1, 1, 1, 1, -1),
         "the linear motion is proven stable from 10 to 38 rpm, but for zones narrower than 5 rpm"),
        ((1, 1, 1, 1, 1, 1, 1),
         "the linear motion is proven stable from 10 to 38 rpm; beyond, unstable zones narrower than 2 rpm "
         "were not searched"),
        ((), "unstable zones narrower than 2 rpm were not searched"),
    ],
)  # fmt: skip
def test_the_words_say_what_is_proven_and_what_was_not_searched(verdicts, words: str) -> None:
    assert plain(proof_words(results_with(of_verdicts(*verdicts)))) == words


def test_where_the_proof_ends_the_chart_says_the_nearest_unstable_speed() -> None:
    assert results_with(of_verdicts(1, 1, 1, 1, 1, 1, 1), [46.0, 58.0]).unstable_rpm == 46.0
    assert results_with(of_verdicts(1, 1, 1, 1, 1, 1, 1, -1), [58.0]).unstable_rpm == 38.0
    assert math.isnan(results_with(of_verdicts(1, 1, 1, 1, 1, 1, 1, 1)).unstable_rpm)


def test_the_nearest_hazard_is_the_proven_speed() -> None:
    search = JumpSearch(
        pair=load_gear_pair("nasa_28_28"),
        speeds_rpm=(10.0, 60.0),
        windows=(),
        branches=(),
        open=(),
        seconds=1.0,
    )
    stable = SimpleNamespace(verdict="stable")
    assert nearest_of(38.0, stable, search, 22.0, roams=False).speed_rpm == 38.0
    assert nearest_of(math.nan, stable, search, 22.0, roams=False) is None
    assert nearest_of(38.0, SimpleNamespace(verdict="unstable"), search, 22.0, roams=False).speed_rpm == 22.0
    here = nearest_of(23.0, stable, search, 22.0, roams=True)
    assert (here.speed_rpm, here.words) == (22.0, "runs come to no motion that repeats")


def test_a_narrow_zone_is_in_the_facts_although_no_node_of_the_chart_is_unstable() -> None:
    """The zone of `test_nearest_unstable.py`, between the nodes of a chart."""
    results = Results(load_gear_pair("fzg_c").with_(LIGHT), QUICK)
    proven = results.proven_stability
    assert 4050.0 < results.unstable_rpm == proven.unstable_rpm < 4056.0
    speeds = np.linspace(*results.speeds, 500)
    chart = xr.Dataset(
        {"verdict": (("speed_rpm", "damping_ratio"), np.ones((500, 1)))},
        {"speed_rpm": speeds, "damping_ratio": [results.pair.mesh.damping_ratio]},
    )
    vars(results)["chart"] = chart
    words = plain(proof_words(results))
    assert words.startswith("the linear motion is proven stable from 2260.6 to 4051 rpm")
    vars(results)["like"] = vars(results)["prediction"] = SimpleNamespace(motion=SimpleNamespace(text=""))
    assert plain(instability(results).claim) == "4051 rpm is unstable"

"""Are the report's verification, margins, map and paper chapters complete, and can their verdicts fail?"""

import copy
import dataclasses
import itertools
import json
import math

import numpy as np
import pytest

import lumped
from floquet.gear.margins import stability_margins
from floquet.gear.multipliers import gear_pair_multipliers
from validation.plots.validity_map import validity_map_figure
from validation.reporting import build, results
from validation.reporting.chapters import CHAPTERS
from validation.reporting.compare import compare
from validation.reporting.verdict import summarise
from validation.validity.flags import contact_loss, film_regime, sliding_reversal
from validation.validity.map import STATES, validity_map, validity_state
from validation.verification import (
    Check,
    OrderCheck,
    Refinement,
    code_checks,
    enough_samples,
    order_checks,
    refinements,
)
from validation.verification.checks import Level

EFFORT = dataclasses.replace(
    results.QUICK,
    samples=64,
    cycles=6,
    sweep_speeds=4,
    chart_speeds=4,
    chart_dampings=2,
    chart_rtol=1e-6,
    map_speeds=3,
    map_torques=2,
    verify=True,
    paper=True,
)


@pytest.fixture(scope="module")
def computed(pair):
    return results.compute(pair, EFFORT, lambda *_: None)


@pytest.fixture(scope="module")
def chapters(computed):
    return {made.key: made for write in CHAPTERS if (made := write(computed)) is not None}


def test_the_report_has_every_chapter_a_verifier_asks_for(chapters):
    asked = [
        "scope",
        "parameters",
        "path_of_contact",
        "mesh_physics",
        "steady_state",
        "losses",
        "code_verification",
        "solution_verification",
        "cross_check",
        "stability",
        "stability_margins",
        "validity",
        "validity_map",
        "paper",
        "errata",
        "limitations",
        "provenance",
    ]
    assert [key for key in chapters if key in asked] == asked


def test_a_report_without_paper_and_verification_says_nothing_of_them(computed):
    bare = dataclasses.replace(computed, paper=None, verification=None)
    keys = {made.key for write in CHAPTERS if (made := write(bare)) is not None}
    assert not keys & {"paper", "errata", "code_verification", "solution_verification"}
    assert summarise(bare).sentence


def test_a_pair_that_the_paper_does_not_suit_gets_the_reason_instead(computed):
    refused = dataclasses.replace(computed, paper=None, paper_refusal="No periodic motion at 4875 rpm.")
    texts = [b.text for write in CHAPTERS if (c := write(refused)) and c.key == "paper" for b in c.blocks]
    assert texts == [
        "Not at the paper's operating points with this gear pair: No periodic motion at 4875 rpm."
    ]


def _table(chapter, key):
    return next(block for block in chapter.blocks if getattr(block, "key", None) == key)


def test_claims_are_shown_with_their_number_of_samples(chapters, computed):
    table = _table(chapters["paper"], "claims")
    assert len(table.rows) == len(computed.paper.claims.claims)
    assert any(f"{EFFORT.claim_samples} samples" in getattr(b, "text", "") for b in chapters["paper"].blocks)
    assert len(_table(chapters["errata"], "errata").rows) == len(computed.paper.errata.errata)


def _numbers(value, path=()):
    """Paths of the numbers in report.json's data."""
    if isinstance(value, dict):
        for key, item in value.items():
            yield from _numbers(item, (*path, key))
    elif isinstance(value, list):
        for place, item in enumerate(value):
            yield from _numbers(item, (*path, place))
    elif isinstance(value, float):
        yield path, value


@pytest.fixture(scope="module")
def document(computed, chapters):
    return build.document(computed, summarise(computed), tuple(chapters.values()), quick=False)


@pytest.mark.parametrize(
    ("table", "least"),
    # Claims have a value, two percentiles and a share each; figure 4 three numbers a law and two twins.
    [("paper/claims", 40), ("paper/claim_details", 15), ("errata/evidence", 100)]
    + [(f"paper/figure{n}", least) for n, least in ((2, 12), (3, 8), (4, 14), (5, 16), (6, 8), (7, 8))],
)
def test_the_gate_sees_every_number_of_the_paper_chapters(document, table, least):
    chapter, key = table.split("/")
    seen = 0
    for path, value in _numbers(document["chapters"][chapter][key]):
        if abs(value) < 1e-4:  # what may count as zero beside others
            continue
        new = copy.deepcopy(document)
        node = new["chapters"][chapter][key]
        for part in path[:-1]:
            node = node[part]
        node[path[-1]] = 1.01 * value
        found = compare(document, new)
        assert len(found.regressions) == 1, (path, value)
        seen += 1
    assert seen >= least


def test_every_number_of_the_page_is_in_the_data(document, chapters):
    # Facts carry numbers in their notes, figures in their captions, tables in their notes.
    told = json.dumps(document, ensure_ascii=False)
    for chapter in chapters.values():
        for block in chapter.blocks:
            words = [getattr(block, "caption", ""), getattr(block, "note", "")]
            words += [fact.note for fact in getattr(block, "items", ()) if hasattr(fact, "note")]
            for text in words:
                assert json.dumps(text, ensure_ascii=False)[1:-1] in told


def test_one_failing_check_turns_the_chapter(computed):
    good = computed.verification
    for part in ("code", "solution", "orders"):
        first = getattr(good, part)[0]
        if part == "code":
            broken = dataclasses.replace(first, value=2 * first.limit)
        elif part == "orders":
            broken = dataclasses.replace(first, observed=first.theory - 1.0)
        else:
            levels = tuple(dataclasses.replace(level, error=2 * first.limit) for level in first.levels)
            broken = dataclasses.replace(first, levels=levels)
        found = dataclasses.replace(good, **{part: (broken, *getattr(good, part)[1:])})
        changed = dataclasses.replace(computed, verification=found)
        key = "solution_verification" if part == "solution" else "code_verification"
        badges = {c.key: c.badge.state for write in CHAPTERS if (c := write(changed)) and c.badge}
        assert badges[key] == "not confirmed"


def test_all_checks_pass_and_say_why_their_limit_is_what_it_is(pair):
    for check in code_checks(pair):
        assert check.passes, check
        assert check.exact
        assert check.reason


def test_methods_show_their_orders():
    rows = order_checks()
    assert {row.method: row.theory for row in rows}["gauss6"] == 6
    assert all(row.passes for row in rows), rows


def test_refining_brings_every_solution_down_to_its_limit(pair):
    studies = refinements(pair, 256)
    assert all(study.passes for study in studies), studies
    steady = next(s for s in studies if s.key == "steady_state")
    errors = [level.error for level in steady.levels]
    # Each stage adds two orders; at these step angles (0.5 rad) that is worth at least a factor ten.
    assert all(fine < 0.1 * coarse for coarse, fine in itertools.pairwise(errors))


def test_samples_are_raised_until_the_peak_is_read_to_three_digits():
    # Law and stiffness of this pair put the peak at a switch: 512 samples miss it by 1.5e-3.
    pair = lumped.load_gear_pair("fzg_c")
    coarse = next(s for s in refinements(pair, 512) if s.key == "sampling")
    assert coarse.error > coarse.limit == 5e-4
    assert not coarse.passes
    samples = enough_samples(pair, 512)
    assert samples > 512
    fine = next(s for s in refinements(pair, samples) if s.key == "sampling")
    assert fine.passes
    assert enough_samples(lumped.load_gear_pair("nasa_28_28"), 512) == 512


def test_numbers_that_are_not_finite_never_pass():
    assert not Check("k", "s", "e", math.nan, 1.0, "r").passes
    assert not OrderCheck("m", 4, math.nan, 8, 1e-3).passes
    assert not Refinement("k", "s", "m", (Level("a", math.nan, True),), 1.0, "r").passes


@pytest.fixture(scope="module")
def margins(pair):
    return stability_margins(pair, (15000.0, 19000.0))


def test_the_widest_tongue_of_the_default_pair_is_where_it_is_known_to_be(margins):
    # 2 w3/2 near 18000 rpm with critical damping 2.7 % for Coulomb friction and bearings of 1e8 N/m; measured
    # when the pair was chosen. The chart behind it has dampings 0.00125 apart.
    (tongue,) = margins.tongues
    assert tongue.label == "2w3/2"
    assert tongue.critical_damping == pytest.approx(0.027, abs=2e-3)
    assert tongue.lower < 17000 < tongue.upper
    assert margins.critical_damping == tongue.critical_damping
    assert margins.speed_margin is None  # 5 % damping is above that
    assert margins.damping_at_speed is None
    assert tongue.distance(margins.rpm) == pytest.approx(tongue.lower - margins.rpm)


def test_distances_at_an_unstable_point(pair, margins):
    inside = stability_margins(
        pair.with_({"mesh.damping_ratio": 0.01, "operating.pinion_speed": 17000.0}), (15000.0, 19000.0)
    )
    assert inside.speed_margin == 0.0
    # The tongue at 1 % damping lies inside that without damping: damping only closes it.
    ((low, high),) = inside.unstable_here
    assert margins.tongues[0].lower < low < 17000 < high < margins.tongues[0].upper
    assert 0.01 < inside.damping_at_speed <= inside.critical_damping
    beside = stability_margins(
        pair.with_({"mesh.damping_ratio": 0.01, "operating.pinion_speed": 15500.0}), (15000.0, 19000.0)
    )
    assert beside.speed_margin == pytest.approx(low - 15500.0, abs=0.05)  # xtol 1e-6 of the speed


def test_contact_is_lost_by_speed_alone_and_the_film_thins_with_torque(pair):
    # Without errors of the teeth the equations are linear in the load, so loads over the static load do not
    # depend on torque; law III makes friction, a small part, depend on it: a few percent.
    data = validity_map(pair, [4875.0, 16500.0], [20.0, 80.0], samples=64)
    lowest = data["lowest_load"].to_numpy()
    np.testing.assert_allclose(lowest[0], lowest[1], atol=0.05)
    assert lowest[0, 1] < 0 < lowest[0, 0]
    assert data["state"].to_numpy().tolist() == [[0, 2], [0, 2]]
    film = data["film_parameter"].to_numpy()
    assert (film[1] < film[0]).all()  # more load, thinner film
    assert (film[:, 1] > film[:, 0]).all()  # more speed, thicker film
    assert STATES[0] == "valid"
    # The map's film is the thinnest of the path, the one that the flag at an operating point reports; 65
    # against 201 places on a smooth curve.
    at = pair.with_({"operating.pinion_speed": 4875.0, "operating.pinion_torque": 80.0})
    assert film[1, 0] == pytest.approx(film_regime(at).value, rel=1e-3)


def test_an_unstable_point_of_the_map_is_not_valid(pair):
    state = validity_state(np.ones(3), np.zeros(3), np.array([0.9, 1.1, 1.0]))
    assert state.tolist() == [0, 2, 0]
    # The widest tongue of the undamped pair; its largest multiplier at 17000 rpm is known to Floquet.
    undamped = pair.with_({"mesh.damping_ratio": 0.0})
    data = validity_map(undamped, [4875.0, 17000.0], [20.0, 56.5], samples=64)
    expected = gear_pair_multipliers(undamped.with_({"operating.pinion_speed": 17000.0})).spectral_radius
    radius = data["spectral_radius"].to_numpy()
    assert radius[1, 1] == pytest.approx(expected, rel=1e-6)
    assert (radius[:, 0] < 1.0).all()
    crosses = [line for line in validity_map_figure(data).axes[0].lines if line.get_marker() == "x"]
    assert [line.get_xdata().tolist() for line in crosses] == [[17000.0, 17000.0]]


def test_the_map_is_the_flag_of_each_point(pair):
    # The map goes by sweeps over speed; each point must be what its own periodic motion says.
    data = validity_map(pair, [900.0, 4875.0], [20.0, 150.0], samples=64)
    for row, torque in enumerate((20.0, 150.0)):
        for column, rpm in enumerate((900.0, 4875.0)):
            at = pair.with_({"operating.pinion_speed": rpm, "operating.pinion_torque": torque})
            g, motion = lumped.geometry(at), lumped.steady_state(at, samples_per_cycle=64)
            lowest = contact_loss(at, g, motion).value * g.base_radius_pinion / torque
            reversal = sliding_reversal(g, motion).value / g.base_pitch
            point = data.isel(torque=row, speed=column)
            assert float(point["lowest_load"]) == pytest.approx(lowest, rel=1e-9)
            assert float(point["reversal"]) == pytest.approx(reversal, rel=1e-9)
    assert float(data["reversal"].max()) > 0.0


def test_slow_and_heavy_running_reverses_the_sliding(pair):
    data = validity_map(pair, [300.0], [10.0, 300.0], samples=64)
    reversal = data["reversal"].to_numpy()[:, 0]
    # Elastic velocities grow with torque, sliding at a given place does not.
    assert reversal[1] > reversal[0]
    assert data["state"].to_numpy()[1, 0] > 0

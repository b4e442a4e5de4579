"""Are the tongues of instability found where they are, all of them, and under their right names?"""

import numpy as np
import pytest
import xarray as xr
from scipy.special import mathieu_a, mathieu_b

from floquet import gear_block, monodromy, predicted_lines, stability_boundaries, stability_chart
from floquet.engine.tongues import Tongue, seeded_nodes, unstable_intervals
from floquet.gear.axes import GearVariation
from floquet.gear.chart import solved
from floquet.gear.tongues import search_grid
from lumped import load_gear_pair
from lumped.errors import ParameterError
from tests.evidence.floquet.reference_systems import mathieu
from tests.unlike_pairs import unlike_pair


def nodes_beside(boundaries: xr.Dataset, chart: xr.Dataset) -> tuple[int, int, int]:
    """Unstable nodes of a chart; those outside every interval; and stable nodes inside of one."""
    speed = chart["speed_rpm"]
    verdict = chart["verdict"]
    inside = (speed >= boundaries["interval_lower"]) & (speed <= boundaries["interval_upper"])
    inside = inside.any(("tongue", "interval"))
    counts = (verdict == -1, (verdict == -1) & ~inside, (verdict == 1) & inside)
    unstable, missed, excess = (int(count.sum()) for count in counts)
    return unstable, missed, excess


@pytest.fixture(scope="module")
def pair():
    """43 teeth drive 22, friction off and light mesh damping, so that tongues exist."""
    return unlike_pair("larger_gear_drives_contact_lost").with_(
        {"mesh.stiffness": {"model": "rectangular"}, "friction.law": "none", "mesh.damping_ratio": 0.002}
    )


def test_mathieu_tongues_end_on_the_characteristic_values() -> None:
    q = 0.8

    def radius(a: np.ndarray) -> np.ndarray:
        return np.array([monodromy(mathieu(float(x), q), rtol=1e-11).spectral_radius for x in a])

    intervals = unstable_intervals(radius, np.linspace(0.3, 5.0, 48), xtol=1e-8, threshold=1e-6)
    expected = [(mathieu_b(1, q), mathieu_a(1, q)), (mathieu_b(2, q), mathieu_a(2, q))]
    ends = sorted(float(x) for pair_of_ends in expected for x in pair_of_ends)
    inside = [x for x in ends if 0.3 < x < 5.0]
    computed = [i.lower for i in intervals if not i.open_below] + [
        i.upper for i in intervals if not i.open_above
    ]
    assert len(computed) == len(inside)
    # The radius leaves one like a square root, so the threshold 1e-6 moves an end by far less than 1e-7.
    assert np.abs(np.array(sorted(computed)) - np.array(inside)).max() < 1e-7


def test_a_thin_tongue_near_its_line_is_not_lost() -> None:
    # Far narrower than the even grid, and displaced from its line by damping.
    line = 3141.0
    centre = line * 0.99997
    half = 1.4e-5 * line

    def radius(x: np.ndarray) -> np.ndarray:
        return 0.999 + 0.01 * np.sqrt(np.clip(1 - ((x - centre) / half) ** 2, 0, None))

    (intervals,) = unstable_intervals(radius, seeded_nodes(np.array([line]), 500.0, 20000.0, 100))
    reach = half * np.sqrt(1 - 0.1**2)  # 0.01 sqrt(1 - s^2) = 0.001
    assert (intervals.lower, intervals.upper) == pytest.approx((centre - reach, centre + reach), rel=1e-8)
    assert not unstable_intervals(radius, np.linspace(500.0, 20000.0, 100))  # the even grid alone loses it


def test_a_peak_above_one_between_two_samples_below_one_is_found() -> None:
    def radius(x: np.ndarray) -> np.ndarray:
        return 0.999 + 0.002 * np.exp(-np.square(x - 5.0))

    nodes = np.arange(0.0, 11.0, 2.0)
    assert radius(nodes).max() < 1.0
    (intervals,) = unstable_intervals(radius, nodes)
    reach = np.sqrt(np.log(2.0))
    assert (intervals.lower, intervals.upper) == pytest.approx((5.0 - reach, 5.0 + reach), rel=1e-6)
    assert intervals.peak == pytest.approx(5.0, abs=0.01)
    assert not intervals.open_below
    assert not intervals.open_above
    (cut,) = unstable_intervals(radius, np.array([0.0, 3.0, 4.5, 5.0]))
    assert cut.open_above
    assert cut.upper == 5.0
    assert not unstable_intervals(lambda x: 1.0 + 1e-10 * np.cos(x), nodes)  # below the threshold


def test_lines_are_sums_and_differences_of_frequencies(pair) -> None:
    lines = predicted_lines(pair, orders=3)
    assert len(lines) == 3 * (6 + 3)  # 6 sums of 3 modes, 3 differences
    for k in (1, 2, 3):
        combination = lines[Tongue(1, 3, 1, k)]
        assert combination == pytest.approx(0.5 * (lines[Tongue(1, 1, 1, k)] + lines[Tongue(3, 3, 1, k)]))
        difference = 0.5 * (lines[Tongue(3, 3, 1, k)] - lines[Tongue(1, 1, 1, k)])
        assert lines[Tongue(1, 3, -1, k)] == pytest.approx(difference)


@pytest.mark.slow
@pytest.mark.parametrize(("name", "slowest", "fastest"), [
    ("larger_gear_drives_contact_lost", 500.0, 20000.0),
    ("contact_ratio_1_1_large_shifts", 500.0, 20000.0),
])  # fmt: skip
def test_no_unstable_node_of_a_dense_chart_is_missed(name: str, slowest: float, fastest: float) -> None:
    pair = unlike_pair(name).with_(friction__law="coulomb", friction__coefficient=0.05)
    axes = {"damping_ratio": [0.002, 0.006, 0.02]}
    boundaries = stability_boundaries(pair, (slowest, fastest), axes, xtol=1e-6)
    chart = stability_chart(pair, {"speed_rpm": np.linspace(slowest, fastest, 2000), **axes})
    unstable, *beside = nodes_beside(boundaries, chart)
    assert unstable > 20
    assert beside == [0, 0]
    # A tongue that is left out would be seen.
    assert nodes_beside(boundaries.isel(tongue=slice(1, None)), chart)[1] > 0


@pytest.mark.parametrize(
    ("law", "name", "values"),
    [
        ("coulomb", "stiffness_variation", [0.0, 0.6, 0.8, 1.0]),
        ("benedict_kelley", "torque", [30.0, 80.0]),  # the law depends on torque
        ("coulomb", "contact_ratio", [1.3, 1.55]),
        ("coulomb", "bearing_stiffness", [5e7, 2e8]),
        ("benedict_kelley", "friction_coefficient", [0.0, 0.1]),  # scaled, keeping its shape
    ],
)
def test_boundaries_over_every_axis_are_those_of_the_chart(pair, name: str, values, law: str) -> None:
    if law == "coulomb":
        varied_pair = pair.with_(friction__law=law, friction__coefficient=0.05, friction__sharpness=None)
    else:  # fitting law II anew at every speed is most of the work, and least for equal gears
        varied_pair = load_gear_pair("nasa_28_28").with_(
            mesh__relief="ignored", mesh__damping_ratio=0.002, friction__law=law
        )
    speeds = np.linspace(13000.0, 19500.0, 120)
    if law != "coulomb":
        speeds = speeds[60:]
    boundaries = stability_boundaries(
        varied_pair, (speeds[0], speeds[-1]), {name: values}, nodes=speeds.size // 2, orders=2, xtol=1e-5
    )
    unstable, *beside = nodes_beside(
        boundaries, stability_chart(varied_pair, {name: values, "speed_rpm": speeds})
    )
    assert beside == [0, 0]
    if name == "stiffness_variation":
        # Without variation nothing is parametric. With it width^2 = (a variation)^2 - d^2 to first order, d
        # by damping (Hsu), so that its differences are those of the variation's square.
        width = (boundaries.upper - boundaries.lower).sel(tongue=boundaries.label == "2w3/2").values[0]
        assert np.isnan(width[0])
        assert np.isfinite(width[1:]).all()
        assert np.divide(*np.diff(width[:0:-1] ** 2)) == pytest.approx(0.36 / 0.28, rel=0.1)
    else:
        assert unstable > 5


def test_damping_closes_tongues_and_absence_is_marked(pair) -> None:
    boundaries = stability_boundaries(pair, (15000.0, 18500.0), {"damping_ratio": [0.01, 0.1]})
    assert boundaries.present.values.tolist() == [[True, False]]
    assert np.isnan(boundaries.lower.values[0, 1])
    assert boundaries.lower.attrs["units"] == "rpm"
    assert boundaries.damping_ratio.attrs["long_name"]


@pytest.mark.parametrize(("speeds", "axes", "word"), [
    ((0.0, 1000.0), None, "speed_rpm"), ((2000.0, 1000.0), None, "speed_rpm"),
    ((1000.0, np.inf), None, "speed_rpm"), ((1e3, 2e3), {"speed_rpm": [1000.0]}, "axes"),
    ((1e3, 2e3), {"unknown": [1.0]}, "axes"),
    ((1e3, 2e3), {"torque": [30.0], "damping_ratio": [0.1]}, "axes"),
])  # fmt: skip
def test_bad_ranges_and_axes_are_refused(pair, speeds, axes, word) -> None:
    with pytest.raises(ParameterError, match=word):
        stability_boundaries(pair, speeds, axes)


def test_no_tongue_of_any_order_is_lost_at_low_speed_and_low_damping() -> None:
    # Tongues of orders up to 67 here, the thinnest a part in 3000 wide.
    changes = {"friction.law": "coulomb", "friction.coefficient": 0.05, "mesh.damping_ratio": 5e-4}
    changes |= {f"bearings.{gear}.loa_damping_ratio": 5e-4 for gear in ("pinion", "gear")}
    pair = load_gear_pair("nasa_28_28").with_(changes, mesh__relief="ignored")
    ends = (500.0, 900.0)
    boundaries = stability_boundaries(pair, ends, xtol=1e-6)
    assert boundaries.complete
    assert boundaries.order.max() > 40
    speeds = np.geomspace(*ends, 20_001)  # steps of 3e-5, a quarter of those of the search

    def radius(x: np.ndarray) -> np.ndarray:
        return solved(GearVariation.of(pair), {"speed_rpm": x}, 1e-9).radius  # labels no regions

    unstable, missed, _ = nodes_beside(boundaries, stability_chart(pair, {"speed_rpm": speeds}, rtol=1e-9))
    assert unstable > 500
    assert missed == 0
    lines = np.array(list(predicted_lines(pair).values()))
    seeded = unstable_intervals(radius, seeded_nodes(lines, *ends, 400))
    assert len(seeded) < int(boundaries.intervals.sum())  # what the grid is for


def test_search_says_when_damping_is_too_low_for_its_grid() -> None:
    undamped = {"mesh.damping_ratio": 0.0}
    undamped |= {f"bearings.{gear}.loa_damping_ratio": 0.0 for gear in ("pinion", "gear")}
    pair = load_gear_pair("nasa_28_28").with_({"mesh.relief": "ignored", "friction.law": "none", **undamped})
    _, complete = search_grid(gear_block(pair), 500.0, 20000.0)
    assert not complete
    # With damped bearings every mode decays: the grid is fine enough, and small.
    damped = pair.with_(bearings__pinion__loa_damping_ratio=0.05)
    grid, complete = search_grid(gear_block(damped), 500.0, 20000.0)
    assert complete
    assert grid.size < 2000

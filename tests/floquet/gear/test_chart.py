"""Are charts that refine themselves those of the full grid, over any axes, and their regions named?"""

import tracemalloc

import numpy as np
import pytest

from floquet import PeriodicSystem, Spectrum, label_regions, monodromy, scan, stability_chart
from floquet.engine.multipliers import radii_with_bounds, verdicts
from floquet.engine.refinement import NodeValues, gaps, refine
from floquet.gear import chart as module
from lumped import load_gear_pair
from lumped.errors import NumericalError, ParameterError
from tests.evidence.floquet.reference_systems import mathieu_many, mathieu_unstable, meissner_trace
from tests.unlike_pairs import UNLIKE, unlike_pair

COULOMB = {"friction.law": "coulomb", "friction.coefficient": 0.05}
COULOMB |= {"friction.maximum": None, "friction.sharpness": None, "friction.thresholds": None}
UNDAMPED = {f"bearings.{g}.{d}_damping_ratio": 0.0 for g in ("pinion", "gear") for d in ("loa", "oloa")}
SPEEDS = np.linspace(3000.0, 19000.0, 161)


@pytest.fixture(autouse=True)
def small_charts_too(monkeypatch):
    monkeypatch.setattr(module, "SMALL", 1024)


@pytest.fixture(scope="module")
def pair():
    return unlike_pair("rack_25_degrees_always_pushing").with_(COULOMB)


#: Of an axis, light damping and constant friction on the pair: its name, changes and values of the axis.
CASES = {
    "damping": ("nasa_28_28", {}, {"damping_ratio": np.linspace(0.0, 0.04, 33)}),
    "friction": (
        "rack_25_degrees_always_pushing", {"mesh.damping_ratio": 0.004},
        {"friction_coefficient": np.linspace(0.0, 0.3, 33)},
    ),
    "torque": (
        "rack_25_degrees_always_pushing", {"mesh.damping_ratio": 0.004},
        {"torque": np.linspace(20.0, 120.0, 17)},
    ),
    "stiffness": (
        "contact_ratio_1_1_large_shifts", {"mesh.damping_ratio": 0.01},
        {"stiffness_variation": np.linspace(0.0, 2.0, 21)},
    ),
    "bearings": (
        "contact_ratio_1_1_large_shifts", {"mesh.damping_ratio": 0.01},
        {"bearing_stiffness": np.geomspace(5e7, 5e8, 21)},
    ),
    "thin tongues": (
        "rack_25_degrees_always_pushing", UNDAMPED | {"mesh.damping_ratio": 0.003},
        {"bearing_stiffness": np.geomspace(3e7, 3e8, 41)},
    ),
}  # fmt: skip
#: Laws II, III, IV and V, with the geometry and stiffness of the pair that has them.
CASES |= {
    name: (name, {}, {"damping_ratio": np.linspace(0.0, 0.04, 21)})
    for name in UNLIKE if name.startswith(("rack", "contact_ratio_2", "larger", "heavily"))
}  # fmt: skip


@pytest.mark.filterwarnings("ignore::lumped.errors.LawRangeWarning")
@pytest.mark.parametrize("case", CASES)
def test_a_refined_chart_has_the_verdicts_of_the_full_grid(case) -> None:
    name, changes, axis = CASES[case]
    varied_pair = unlike_pair(name) if name in UNLIKE else load_gear_pair(name)
    varied_pair = varied_pair if case == name else varied_pair.with_(COULOMB | changes)
    # The other laws are fitted anew at every speed, which is most of the work: every second one.
    axes = {**axis, "speed_rpm": SPEEDS[::2] if case == name else SPEEDS}
    got = stability_chart(varied_pair, axes, rtol=1e-8)
    full = stability_chart(varied_pair, axes, rtol=1e-8, refine=False)
    assert 0.0 < float(got.known.mean()) < 0.95
    assert bool(full.known.all())
    assert got.spectral_radius.dims == full.spectral_radius.dims == tuple(axes)
    assert (got.verdict == full.verdict).all()
    evaluated = got.known.to_numpy()
    for name in ("spectral_radius", "error"):  # the same to rounding: batches do not change a point
        np.testing.assert_allclose(
            got[name].values[evaluated], full[name].values[evaluated], rtol=1e-9, atol=1e-12
        )
    assert not got.proven.values[~evaluated].any()
    # The misfit is that of evaluated nodes; where two multipliers change places the radius bends between.
    difference = np.abs(got.spectral_radius - full.spectral_radius).to_numpy()
    assert np.mean(difference <= got.error.to_numpy()) > 0.98
    assert difference.max() < 0.05


def test_axes_in_any_order_and_a_third_one_plane_by_plane(pair) -> None:
    rng = np.random.default_rng(3)
    axes = {
        "torque": np.array([90.0, 40.0]),
        "damping_ratio": rng.permutation(np.linspace(0.0, 0.04, 21)),
        "speed_rpm": rng.permutation(SPEEDS),
    }
    fractions: list[float] = []
    mixed = stability_chart(pair, axes, rtol=1e-8, progress=fractions.append)
    alone = {name: np.sort(values) for name, values in axes.items() if name != "torque"}
    one = stability_chart(pair.with_(operating__pinion_torque=40.0), alone, rtol=1e-8)
    plane = mixed.sel(torque=40.0).sortby(["damping_ratio", "speed_rpm"])
    assert mixed.spectral_radius.dims == tuple(axes)
    assert (plane.verdict == one.verdict).all()
    assert (plane.known == one.known).all()
    assert fractions == sorted(fractions)
    assert fractions[-1] == 1.0


def test_the_full_grid_is_the_same_in_pieces_and_tells_its_progress(pair, monkeypatch) -> None:
    axes = {"damping_ratio": [0.0, 0.02, 0.05], "speed_rpm": np.linspace(2000.0, 18000.0, 400)}
    in_one_piece = stability_chart(pair, axes, rtol=1e-8, store="all", refine=False)
    monkeypatch.setattr(module, "_CHUNK", 450)
    fractions: list[float] = []
    pieces = stability_chart(pair, axes, rtol=1e-8, refine=False, progress=fractions.append)
    assert np.array_equal(pieces["spectral_radius"], in_one_piece["spectral_radius"])
    assert fractions == pytest.approx([450 / 1200, 900 / 1200, 1.0])
    assert (np.abs(in_one_piece.multipliers).max("multiplier") == in_one_piece.spectral_radius).all()
    assert (np.diff(np.abs(in_one_piece.multipliers), axis=-1) <= 0.0).all()
    assert "multipliers" not in pieces


def test_cells_are_proven_and_others_evaluated() -> None:
    """What is proven between the nodes holds at random points; axes in any order."""
    pair = load_gear_pair("nasa_art_25_31").with_(COULOMB)
    axes = {"damping_ratio": np.linspace(0.02, 0.0, 21), "speed_rpm": np.linspace(12000.0, 20000.0, 81)}
    for changes in ({}, {"friction.law": "xu_kahraman"}, UNDAMPED):
        varied_pair = pair.with_(changes)
        rng = np.random.default_rng(5)
        chart = stability_chart(varied_pair, axes, rtol=1e-8, prove=True)
        cells = chart.cell_verdict.to_numpy()
        share = chart.proven_share
        assert share == pytest.approx((cells != 0).mean())
        assert (cells < 0).any()
        assert (share < 0.5 and not (cells > 0).any()) if changes is UNDAMPED else share > 0.94
        evaluated = chart.known.transpose("speed_rpm", "damping_ratio")[:, ::-1].to_numpy()
        for i, j in np.argwhere(cells == 0):
            assert evaluated[i : i + 2, j : j + 2].all()
        more = {}
        for name, count in (("damping_ratio", 2), ("speed_rpm", 2)):
            edges = np.sort(axes[name])
            more[name] = (edges[:-1] + rng.uniform(0.0, 1.0, (count, 1)) * np.diff(edges)).T.ravel()
        full = stability_chart(varied_pair, more, rtol=1e-8, refine=False).verdict
        wanted = np.repeat(np.repeat(cells, 2, axis=0), 2, axis=1)
        assert (full.transpose("speed_rpm", "damping_ratio").to_numpy() == wanted)[wanted != 0].all()


def test_a_refined_chart_takes_little_more_memory_than_its_result() -> None:
    """A node of the result has 19 bytes; the number of its region has 4, the mask of regions 1."""
    pair = load_gear_pair("nasa_28_28").with_(COULOMB)

    def peak(speeds: int) -> int:
        axes = {
            "speed_rpm": np.linspace(500.0, 20000.0, speeds),
            "damping_ratio": np.linspace(0.001, 0.1, 800),
        }
        tracemalloc.start()
        chart = stability_chart(pair, axes, rtol=1e-8)
        largest = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        assert sum(chart[name].dtype.itemsize for name in chart if chart[name].ndim == 2) == 19
        return largest

    assert (peak(1000) - peak(300)) / (700 * 800) < 26.0


def test_slow_axes_tell_their_progress_value_by_value(pair) -> None:
    axes = {"speed_rpm": np.array([4000.0, 5000.0]), "torque": np.array([20.0, 60.0, 90.0])}
    fractions: list[float] = []
    chart = stability_chart(pair, axes, progress=fractions.append)
    assert fractions == pytest.approx([1 / 3, 2 / 3, 1.0])
    assert chart["spectral_radius"].dims == ("speed_rpm", "torque")


def test_regions_are_named_measured_and_found_nearest(pair, monkeypatch) -> None:
    monkeypatch.setattr(module, "_COUNTED", 5000)  # nodes are counted in 33 parts
    varied_pair = pair.with_({"mesh.damping_ratio": 0.01, "operating.pinion_speed": 15000.0})
    chart = stability_chart(varied_pair, rtol=1e-8)
    assert chart.spectral_radius.shape == (801, 201)
    regions = label_regions(varied_pair, chart)
    assert [str(r.label) for r in regions] == list(chart.region_label.values)
    assert sum(r.nodes for r in regions) == int((chart.verdict < 0).sum())
    assert chart.thinnest_width == pytest.approx(min(r.width for r in regions))
    for region in regions:
        node = chart.sel(region.point)
        assert node.known
        assert node.spectral_radius == region.radius
    # Single speeds on either side: stable from the pair's own speed up to the edge, unstable beyond.
    edge = float(chart.nearest_edge_speed_rpm)
    step = 0.5 * float(np.median(np.diff(chart.speed_rpm)))
    beyond = edge - step if edge < 15000.0 else edge + step
    stable_speeds = np.linspace(15000.0, edge + np.sign(15000.0 - edge) * step, 50)
    assert (stability_chart(varied_pair, {"speed_rpm": stable_speeds}).verdict > 0).all()
    assert (stability_chart(varied_pair, {"speed_rpm": [beyond]}).verdict < 0).all()


def mathieu_point(point: dict[str, float]) -> PeriodicSystem:
    a = point["a"]
    q = point["q"]
    return PeriodicSystem(lambda t: [[0.0, 1.0], [-(a - 2 * q * np.cos(2 * t)), 0.0]], np.pi)


def at_point(point: dict[str, float]) -> Spectrum:
    return monodromy(mathieu_point(point), 1e-8)


def test_chart_equals_single_points() -> None:
    axes = {"a": [1.1, 3.0], "q": [0.2, 0.7, 1.5]}
    serial = scan(at_point, axes)
    single = at_point({"a": 3.0, "q": 0.7})
    assert serial.spectral_radius.sel(a=3.0, q=0.7).item() == single.spectral_radius
    assert serial.error.sel(a=3.0, q=0.7).item() == single.error
    for variable in serial.data_vars.values():
        assert variable.attrs["units"]
        assert variable.attrs["long_name"]


def of_trace(trace: float) -> Spectrum:
    """Multipliers of an undamped equation of second order: their product is 1."""
    pair = np.array(np.roots([1.0, -trace, 1.0]), dtype=complex)
    return Spectrum(pair, np.full(2, 1e-7), 1.0)  # the root of the rounding of a double multiplier


@pytest.mark.parametrize("shape", [(401, 201), (201, 401)])
def test_a_refined_scan_finds_the_boundaries_of_meissner(shape) -> None:
    """|trace| = 2 (Meissner 1918); the stable regions have modulus 1, which is undecided."""
    delta = np.linspace(0.5, 9.0, shape[0])
    epsilon = np.linspace(0.0, 0.45, shape[1])
    got = scan(
        lambda point: of_trace(meissner_trace(point["delta"], point["epsilon"])),
        {"delta": delta, "epsilon": epsilon},
        refine=True,
    )
    trace = np.array([[meissner_trace(d, e) for e in epsilon] for d in delta])
    sure = np.abs(np.abs(trace) - 2.0) > 1e-6
    assert ((got.verdict.values < 0) == (np.abs(trace) > 2.0))[sure].all()
    assert 0.0 < float(got.known.mean()) < 0.4
    assert "multipliers" not in got


def test_refinement_finds_the_tongues_of_mathieu() -> None:
    """To m = 6, undecided where |multiplier| = 1, and be they thinner than a step of a."""
    a = np.linspace(0.5, 42.0, 401)
    q = np.linspace(0.0, 12.0, 81)

    def ask(nodes):
        i, j = np.unravel_index(nodes, (a.size, q.size))
        values, errors = mathieu_many(a[i], q[j])
        radius, error = radii_with_bounds(values, errors)
        return NodeValues(radius, verdicts(radius, error), gaps(values))

    got = refine((a.size, q.size), np.ones(a.size), ask, rows=(0, -1))
    assert got.known.mean() < 0.4
    for j in range(1, q.size):
        unstable, edges = mathieu_unstable(a, q[j])
        sure = np.abs(a[:, None] - edges).min(axis=1) > 1e-4
        assert ((got.verdict[:, j] < 0) == unstable)[sure].all()


def test_failing_point_is_named() -> None:
    def evaluate(point: dict[str, float]) -> Spectrum:
        if point["speed"] > 1.5:
            raise NumericalError("no luck")
        return monodromy(PeriodicSystem(lambda t: [[-1.0]], 1.0))

    with pytest.raises(NumericalError, match="at speed = 2: no luck"):
        scan(evaluate, {"speed": [1.0, 2.0]})


@pytest.mark.parametrize(
    "axes", [{}, {"a": []}, {"a": [1.0, np.nan]}, {"a": [1.0, 1.0]}, {"a": [[1.0], [2.0]]}]
)
def test_unusable_axes_of_a_scan_are_refused(axes: dict[str, list[float]]) -> None:
    with pytest.raises(ParameterError, match="axes"):
        scan(at_point, axes)
    with pytest.raises(ParameterError, match="refine"):
        scan(mathieu_point, {"a": [1.0, 2.0], "q": [0.1]}, refine=True)


@pytest.mark.parametrize(("axes", "options", "word"), [
    ({"speed_rpm": np.arange(1.0, 6000.0), "damping_ratio": np.linspace(0, 1, 6000)}, {}, "at most 25000000"),
    ({"speed_rpm": [900.0]}, {"store": "some"}, "store"),
    ({"speed_rpm": SPEEDS, "damping_ratio": np.arange(9) / 100}, {"store": "all"}, "refine=False"),
    ({"speed_rpm": SPEEDS}, {"prove": True}, "prove"),
    ({"torque": [50.0, 60.0], "speed_rpm": SPEEDS}, {"prove": True}, "prove"),
    ({"speed": [1000.0]}, {}, "axes"), ({"speed_rpm": [0.0]}, {}, "axes"),
    ({"damping_ratio": [-0.1]}, {}, "axes"), ({"torque": [0.0]}, {}, "axes"),
])  # fmt: skip
def test_what_cannot_be_computed_is_refused_before_any_work(pair, axes, options, word) -> None:
    with pytest.raises(ParameterError, match=word):
        stability_chart(pair, axes, **options)

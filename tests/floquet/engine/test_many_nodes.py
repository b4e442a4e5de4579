"""Are nodes that are evaluated together those that are evaluated alone, and batches those of closed forms?"""

import numpy as np
import pytest
from scipy.special import mathieu_b

from floquet import (
    FourierSeries,
    PeriodicMatrix,
    PeriodicSystem,
    PeriodicSystems,
    PiecewisePolynomial,
    Spectrum,
    from_second_order,
    monodromy,
    scan,
)
from floquet.engine import nodes as module
from floquet.engine.formula_steps import proven_flows
from floquet.engine.many_multipliers import quick_multipliers
from floquet.engine.neutral import separate_from_mirror_images
from lumped.errors import NumericalError, ParameterError
from tests.evidence.floquet.reference_systems import mathieu_unstable, meissner_trace

PERIOD = 1.7
ROOT = np.random.default_rng(8).normal(size=(3, 3))


def functions(kind: str, depth: float, period: float):
    wave = FourierSeries(period, 0.1, [depth, 0.0, 0.3 * depth], [0.2 * depth])
    steps = PiecewisePolynomial([0.0, 0.3 * period, period], [[depth, 0.2], [-depth, 0.0]])
    same = FourierSeries(PERIOD, 0.0, [0.2])
    mixed = {"mixed": steps if depth > 0.3 else wave}
    return mixed.get(kind) or {
        "waves": wave, "steps": steps, "product": wave * steps - 0.3, "sum": same + wave,
        "number of pieces": PiecewisePolynomial(np.linspace(0.0, period, 3 + int(depth > 0.3)),
                                                [[depth]] * 2 + [[-depth]] * int(depth > 0.3)),
    }[kind]  # fmt: skip


def family(kind: str, states: int, damping: float):
    n = states // 2
    shape = (ROOT + ROOT.T)[:n, :n]

    def at(point):
        period = PERIOD if kind == "sum" else point["period"]
        stiffness = PeriodicMatrix(
            np.diag([3.0, 5.0, 8.0][:n]), (functions(kind, point["depth"], period), shape)
        )
        return from_second_order(np.eye(n), damping * np.eye(n), stiffness, period)

    return at


@pytest.mark.parametrize("kind", ["waves", "steps", "product", "sum", "mixed", "number of pieces"])
@pytest.mark.parametrize(("states", "damping"), [(2, 0.0), (4, 0.01), (6, 0.0)])
def test_nodes_together_are_nodes_alone(kind, states, damping) -> None:
    axes = {"period": np.linspace(0.9, 2.4, 5), "depth": np.linspace(0.05, 0.6, 4)}
    evaluate = family(kind, states, damping)
    chart = scan(evaluate, axes, rtol=1e-9)
    assert chart.attrs["certificate"] == "proven"
    numbers = {"unstable": -1, "undecided": 0, "stable": 1, "neutral": 2}
    seen = set()
    for period in axes["period"]:
        for depth in axes["depth"]:
            node = chart.sel(period=period, depth=depth)
            alone = monodromy(evaluate({"period": period, "depth": depth}), 1e-9)
            assert int(node["verdict"]) == numbers[alone.verdict]
            seen.add(alone.verdict)
            apart = np.abs(node["multipliers"].values[:, None] - alone.multipliers)
            both = node["multiplier_errors"].values + alone.multiplier_errors
            assert (apart.min(axis=1) <= both).all()
            assert abs(node["spectral_radius"] - alone.spectral_radius) <= node["error"] + alone.error
    assert seen <= {"unstable", "stable" if damping else "neutral"}


def test_nodes_next_to_an_edge_have_the_verdict_of_single_nodes() -> None:
    """Two multipliers that nearly meet, on both sides of a characteristic value."""
    edge = float(mathieu_b(1, 0.7))

    def at(point):
        wave = FourierSeries(np.pi, 0.0, [1.0])
        return from_second_order(1.0, 0.0, PeriodicMatrix(edge + point["a"], (wave, -1.4)), np.pi)

    offsets = np.concatenate([-np.geomspace(1e-4, 1e-9, 16), np.geomspace(1e-9, 1e-4, 16)])
    verdict = scan(at, {"a": offsets}, rtol=1e-10)["verdict"].values
    assert (verdict[:12] == 2).all()
    assert (verdict[-12:] == -1).all()
    numbers = {"unstable": -1, "undecided": 0, "neutral": 2}
    assert verdict.tolist() == [numbers[monodromy(at({"a": a}), 1e-10).verdict] for a in offsets]


def test_the_careful_bound_proves_what_the_quick_bound_cannot() -> None:
    """Four states just outside of the tongue at a sum of frequencies: disks of the quick bound meet."""
    K, K1 = np.diag([1.0, 3.0]), 0.3 * np.array([[0.0, 1.0], [1.0, 0.0]])

    def at(point):
        period = 2.0 * np.pi / point["frequency"]
        stiffness = PeriodicMatrix(K, (FourierSeries(period, 0.0, [1.0]), K1))
        return from_second_order(np.eye(2), np.zeros((2, 2)), stiffness, period)

    low, high = 1.0 + np.sqrt(3.0), 1.5 + np.sqrt(3.0)
    for _ in range(50):
        middle = 0.5 * (low + high)
        radius = np.abs(np.linalg.eigvals(monodromy(at({"frequency": middle})).matrix)).max()
        low, high = (middle, high) if radius > 1.0 + 1e-7 else (low, middle)
    frequencies = low + np.geomspace(1e-14, 1e-10, 17)
    verdict = scan(at, {"frequency": frequencies}, rtol=1e-8)["verdict"].values
    alone = [monodromy(at({"frequency": f}), 1e-8).verdict for f in frequencies]
    assert verdict.tolist() == [{"unstable": -1, "undecided": 0, "neutral": 2}[word] for word in alone]
    systems = [at({"frequency": f}) for f in frequencies]
    flows = proven_flows([(system, system.A) for system in systems], 1e-8, 1000)
    quick = quick_multipliers(flows.matrices, flows.bounds)
    by_quick_bound = quick.safe & separate_from_mirror_images(quick.values, quick.errors)
    assert ((verdict == 2) & ~by_quick_bound).any()


def test_a_node_that_fails_in_a_group_is_named(monkeypatch) -> None:
    def at(point):
        wave = FourierSeries(1.0, 0.0, [1.0])
        return PeriodicSystem(PeriodicMatrix(point["rate"], (wave, 0.1)), 1.0)

    with pytest.raises(NumericalError, match="at rate = 900: the state grows beyond"):
        scan(at, {"rate": [0.1, 900.0, 1.0]})
    monkeypatch.setattr(module, "_MAX_SUBSTEPS", 20)
    assert scan(at, {"rate": [0.1, 40.0]})["proven"].all()  # more steps than in a group are taken alone


def test_systems_of_all_kinds_in_one_chart() -> None:
    """A formula, a callable, and multipliers that are known otherwise."""

    def at(point):
        if point["kind"] == 1.0:
            return from_second_order(1.0, 0.0, 2.0, 1.0)
        if point["kind"] == 2.0:
            return PeriodicSystem(lambda t: [[0.0, 1.0], [-2.0, -0.1]], 1.0)
        return Spectrum(np.array([0.5, 0.25], dtype=complex), np.array([0.1, 0.1]), 1.0)

    chart = scan(at, {"kind": [3.0, 1.0, 2.0]})
    assert chart["verdict"].values.tolist() == [1, 2, 1]
    assert chart["proven"].values.tolist() == [False, True, False]
    assert chart["spectral_radius"].values == pytest.approx([0.5, 1.0, np.exp(-0.05)], abs=1e-9)


def mathieus(points):
    """x'' + (a - 2 q cos 2t) x = 0 for arrays of a and q."""

    def A(phases):
        out = np.zeros((points["a"].size, phases.size, 2, 2))
        out[..., 0, 1] = 1.0
        out[..., 1, 0] = -points["a"][:, None] + 2.0 * points["q"][:, None] * np.cos(2.0 * np.pi * phases)
        return out

    return PeriodicSystems(A, np.pi)


def test_a_batch_of_mathieus_equations_is_that_of_scipy() -> None:
    axes = {"a": np.linspace(-0.4, 9.7, 160), "q": np.linspace(0.05, 4.0, 30)}
    chart = scan(mathieus, axes, batched=True)
    assert chart.attrs["certificate"] == "estimate"
    for j, q in enumerate(axes["q"]):
        unstable, edges = mathieu_unstable(axes["a"], q)
        sure = np.abs(axes["a"][:, None] - edges).min(axis=1) > 1e-4
        # A callable proves nothing: a stable node without damping is undecided.
        assert (chart["verdict"].values[sure, j] == np.where(unstable, -1, 0)[sure]).all()
    assert float(chart["error"].median()) < 1e-8


def meissners(points, breaks=(0.5,), switch=0.5):
    """Meissner's equation with a period of its own for each system."""

    def A(phases):
        out = np.zeros((points["delta"].size, phases.size, 2, 2))
        out[..., 0, 1] = 1.0
        out[..., 1, 0] = -points["delta"][:, None] * np.where(phases < switch, 1.4, 0.6)
        return out

    return PeriodicSystems(A, points["period"], breaks)


def test_errors_of_a_batch_are_estimated_and_jumps_are_named() -> None:
    axes = {"delta": np.linspace(0.5, 6.0, 12), "period": np.linspace(0.7, 4.0, 9)}
    chart = scan(meissners, axes, batched=True)
    for i, j in np.ndindex(12, 9):
        delta, period = axes["delta"][i], axes["period"][j]
        trace = meissner_trace(delta, 0.4 * delta, period)
        error = abs(chart["multipliers"].values[i, j].sum().real - trace)
        assert error <= chart["multiplier_errors"].values[i, j].sum() < 1e-4
        if abs(abs(trace) - 2.0) > 1e-3:
            assert error < 1e-11
    with pytest.raises(NumericalError, match="Name the switches"):
        scan(
            lambda points: meissners(points, (), 0.3172), {"delta": [2.0], "period": [2.0, 3.0]}, batched=True
        )


def test_a_batch_refines_itself_as_single_systems_do() -> None:
    axes = {"a": np.linspace(0.2, 3.6, 65), "q": np.linspace(0.02, 0.8, 33)}
    refined, full = (scan(mathieus, axes, batched=True, refine=refine) for refine in (True, False))
    assert ((refined["verdict"] < 0) == (full["verdict"] < 0)).all()
    assert float(refined["known"].mean()) < 1.0


def flapping_blade(point):
    """beta'' + g (1 + 4/3 mu sin) beta' + (1 + g (4/3 mu cos + mu^2 sin 2)) beta = 0 (Peters 1971)."""
    turn, mu, air = 2.0 * np.pi, point["mu"], point["lock"] / 8.0
    along = FourierSeries(turn, 1.0, [], [4.0 / 3.0 * mu])
    across = FourierSeries(turn, 0.0, [4.0 / 3.0 * mu], [0.0, mu**2])
    return from_second_order(1.0, PeriodicMatrix(0.0, (along, air)), PeriodicMatrix(1.0, (across, air)), turn)


@pytest.mark.parametrize(("evaluate", "axes"), [
    (flapping_blade, {"mu": np.linspace(0.0, 2.0, 65), "lock": np.linspace(0.5, 15.0, 33)}),
    (family("steps", 6, 0.05), {"period": np.linspace(0.9, 4.4, 65), "depth": np.linspace(0.05, 0.6, 33)}),
    (family("waves", 4, 0.0), {"period": np.linspace(0.9, 4.4, 65), "depth": np.linspace(0.05, 0.6, 33)}),
])  # fmt: skip
def test_a_family_of_any_function_refines_itself(evaluate, axes) -> None:
    """No verdict differs from that of the whole chart, and no radius by more than a leaf may be wrong."""
    refined, whole_chart = (scan(evaluate, axes, refine=refine, rtol=1e-9) for refine in (True, False))
    assert (np.sign(refined["verdict"]) == np.sign(whole_chart["verdict"])).all()
    assert {-1} < set(whole_chart["verdict"].to_numpy().ravel().tolist())
    assert float(refined["known"].mean()) < 0.95
    error = np.abs(refined["spectral_radius"] - whole_chart["spectral_radius"])
    # 4e-3 is checked at the nodes of a leaf that are evaluated; between them twice as much is possible.
    assert float((error / np.maximum(whole_chart["spectral_radius"], 1.0)).max()) < 8e-3


@pytest.mark.parametrize(("systems", "field", "word"), [
    (lambda p: PeriodicSystems(lambda phases: np.zeros((3, phases.size, 2, 2)), 1.0), "A", "(2, "),
    (lambda p: PeriodicSystems(lambda phases: np.zeros((2, phases.size, 2, 3)), 1.0), "A", "systems, phases"),
    (lambda p: PeriodicSystems(lambda phases: np.zeros((2, phases.size, 2, 2)) * 1j, 1.0), "A", "complex"),
    (lambda p: PeriodicSystems(np.eye(2), 1.0), "A", "callable"),
    (lambda p: PeriodicSystems(lambda phases: phases, [1.0, -1.0]), "period", "> 0"),
    (lambda p: PeriodicSystems(lambda phases: phases, [1.0, 1.0, 1.0]), "period", "2 systems"),
    (lambda p: PeriodicSystems(lambda phases: phases, 1.0, (1.5,)), "break_phases", "1"),
    (lambda p: 3.0, "evaluate", "PeriodicSystems"),
])  # fmt: skip
def test_what_is_no_batch_is_refused(systems, field, word) -> None:
    with pytest.raises(ParameterError) as refused:
        scan(systems, {"a": [1.0, 2.0]}, batched=True)
    assert refused.value.problems[0].field == field
    assert word in str(refused.value)
    with pytest.raises(ParameterError, match="batched"):
        scan(systems, {"a": [1.0, 2.0]}, batched=1)


def test_a_batch_that_grows_without_end_says_where() -> None:
    def growing(points):
        return PeriodicSystems(lambda phases: np.full((3, phases.size, 1, 1), 900.0), 1.0)

    with pytest.raises(NumericalError, match="between a = 1 and a = 4: a state grows"):
        scan(growing, {"a": [1.0, 2.0, 4.0]}, batched=True)

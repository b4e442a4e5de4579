"""Does a chart show at every point what the single computation gives there?"""

import numpy as np
import pytest
from scipy.special import mathieu_a, mathieu_b

from floquet import PeriodicSystem, Spectrum, monodromy, scan
from floquet.engine.multipliers import radii_with_bounds, verdicts
from floquet.engine.refinement import refine
from lumped.errors import NumericalError, ParameterError
from tests.evidence.floquet.reference_systems import mathieu_many, mathieu_unstable, meissner_trace


def mathieu_point(point: dict[str, float]) -> PeriodicSystem:
    a, q = point["a"], point["q"]
    return PeriodicSystem(lambda t: [[0.0, 1.0], [-(a - 2 * q * np.cos(2 * t)), 0.0]], np.pi)


def at_point(point: dict[str, float]) -> Spectrum:
    return monodromy(mathieu_point(point), 1e-8)


def test_ince_strutt_chart() -> None:
    # With q > 0 the Mathieu equation is stable exactly for a_m(q) < a < b_(m+1)(q) (DLMF 28.17).
    q_values, a_values = [0.5, 2.0], np.linspace(-1.0, 9.0, 31)
    told: list[float] = []
    result = scan(at_point, {"q": q_values, "a": a_values}, progress=told.append)
    assert result.spectral_radius.dims == ("q", "a")
    assert told == pytest.approx(np.arange(1, 63) / 62)
    for q in q_values:
        edges = np.sort([mathieu_a(m, q) for m in range(4)] + [mathieu_b(m, q) for m in range(1, 5)])
        inside = np.searchsorted(edges, a_values) % 2 == 1  # between a_m and b_(m+1)
        verdict = result.verdict.sel(q=q).values
        # Conservative: inside the stable bands |multiplier| = 1, which no error bound can call stable.
        assert (verdict[inside] == 0).all()
        assert (verdict[~inside] == -1).all()


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
    delta, epsilon = np.linspace(0.5, 9.0, shape[0]), np.linspace(0.0, 0.45, shape[1])
    got = scan(
        lambda at: of_trace(meissner_trace(at["delta"], at["epsilon"])),
        {"delta": delta, "epsilon": epsilon},
        refine=True,
    )
    trace = np.array([[meissner_trace(d, e) for e in epsilon] for d in delta])
    sure = np.abs(np.abs(trace) - 2.0) > 1e-6
    assert ((got.verdict.values < 0) == (np.abs(trace) > 2.0))[sure].all()
    assert 0.0 < float(got.known.mean()) < 0.4
    assert "multipliers" not in got


def test_refinement_finds_the_tongues_of_mathieu() -> None:
    """To m = 6, undecided where |multiplier| = 1; a tongue may end where it is two steps of a wide."""
    a, q = np.linspace(0.5, 42.0, 401), np.linspace(0.0, 12.0, 81)

    def ask(flat):
        i, j = np.unravel_index(flat, (a.size, q.size))
        radius, error = radii_with_bounds(*mathieu_many(a[i], q[j]))
        return radius, verdicts(radius, error).astype(np.intp)

    got = refine((a.size, q.size), np.ones(a.size), ask, rows=(0, -1))
    assert got.known.mean() < 0.35
    for j in range(1, q.size):
        unstable, edges = mathieu_unstable(a, q[j])
        sure = np.abs(a[:, None] - edges).min(axis=1) > 1e-4
        inside = np.searchsorted(edges, a)  # between edges inside - 1 and inside
        width = np.diff(edges, prepend=-np.inf, append=np.inf)[inside]
        sure &= ~unstable | (width > 2.0 * (a[1] - a[0]))
        assert ((got.verdict[:, j] < 0) == unstable)[sure].all()


def test_a_refined_scan_needs_two_axes() -> None:
    with pytest.raises(ParameterError, match="refine"):
        scan(mathieu_point, {"a": [1.0, 2.0], "q": [0.1]}, refine=True)


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
def test_unusable_axes_are_refused(axes: dict[str, list[float]]) -> None:
    with pytest.raises(ParameterError, match="axes"):
        scan(at_point, axes)

"""Is an interpolated chart the direct one, within its bounds, and does it say when it cannot be?"""

from __future__ import annotations

import numpy as np
import pytest

from floquet import gear_block, stability_chart
from floquet.rank_one.batch import FastMonodromy, FastMultipliers, fast_monodromies, fast_multipliers
from floquet.rank_one.interpolation import interpolant, interpolated_multipliers
from lumped import load_gear_pair
from lumped.errors import NumericalError, ParameterError


@pytest.fixture(scope="module")
def pair():
    return load_gear_pair("nasa_28_28")


def test_error_falls_to_the_tolerance_and_is_bounded(pair) -> None:
    block = gear_block(pair)
    T = block.period * np.array([0.5, 1.7])
    turns = block.modal().omega.max() * (T[1] - T[0])

    def flow(t: np.ndarray, z: np.ndarray):
        return fast_monodromies(block, t, z)

    rng = np.random.default_rng(5)
    t, z = rng.uniform(*T, 60), rng.uniform(0.0, 2.0, 60)
    exact = flow(t, z)
    for tolerance in (1e-4, 1e-7, 1e-10):
        series = interpolant(flow, (T[0], T[1]), (0.0, 2.0), turns, tolerance)
        found = np.array([series(t[i : i + 1], z[i : i + 1])[0, 0] for i in range(60)])
        error = np.linalg.norm(found - exact.matrices, axis=(1, 2)).max()
        size = np.linalg.norm(exact.matrices, axis=(1, 2)).max()
        assert error <= series.error + exact.errors.max()
        assert error < 10 * tolerance * size


def test_multipliers_at_many_speeds_and_dampings(pair) -> None:
    block = gear_block(pair)
    T = block.period * np.linspace(0.2, 8.0, 41)  # three bands
    z = np.linspace(0.0, 2.0, 7)

    asked: list[int] = []

    def flow(t: np.ndarray, f: np.ndarray):
        asked.append(t.size)
        return fast_monodromies(block, t, f)

    parts: list[tuple[np.ndarray, FastMultipliers]] = []
    interpolated_multipliers(
        flow, T, z, float(block.modal().omega.max()), 1e-11, lambda rows, found: parts.append((rows, found))
    )
    rows = np.concatenate([rows for rows, _ in parts])
    assert sorted(rows) == list(range(41))
    order = np.argsort(rows)
    multipliers, errors = (
        np.concatenate([getattr(found, name).reshape(-1, 7, 6) for _, found in parts])[order].reshape(-1, 6)
        for name in ("multipliers", "errors")
    )
    direct = fast_multipliers(block, np.repeat(T, 7), np.tile(z, 41))
    distance = np.abs(multipliers[:, :, None] - direct.multipliers[:, None, :]).min(axis=2)
    assert (distance <= errors + direct.errors.max(axis=1, keepdims=True)).all()
    assert distance.max() < 1e-9
    assert sum(asked) < 40_000  # a million points would be 25 times as many


@pytest.mark.parametrize(
    ("law", "axes"),
    [
        ("coulomb", {"speed_rpm": np.linspace(900, 15000, 90), "damping_ratio": [0.0, 0.03, 0.08]}),
        ("coulomb", {"damping_ratio": [0.0, 0.05], "speed_rpm": [4000.0, 2500.0, 17000.0]}),
        ("coulomb", {"friction_coefficient": [0.0, 0.05, 0.1], "speed_rpm": [2000.0, 9000.0]}),
        ("xu_kahraman", {"speed_rpm": [1500.0, 5000.0, 16000.0], "damping_ratio": [0.01, 0.04]}),
        ("smoothed_coulomb", {"speed_rpm": np.linspace(1500.0, 16000.0, 70)}),
        ("benedict_kelley", {"speed_rpm": np.linspace(1500.0, 16000.0, 70), "damping_ratio": [0.01, 0.04]}),
        ("composite", {"speed_rpm": np.linspace(1500.0, 16000.0, 70), "damping_ratio": [0.01, 0.04]}),
        ("coulomb", {"speed_rpm": [3000.0, 9000.0], "torque": [30.0, 90.0], "damping_ratio": [0.02, 0.03]}),
    ],
)
def test_chart_agrees_with_the_direct_one(pair, law: str, axes: dict[str, object]) -> None:
    here = pair.with_(friction__law=law)
    direct, fast = stability_chart(here, axes), stability_chart(here, axes, method="chebyshev")
    difference = np.abs(direct.spectral_radius - fast.spectral_radius)
    assert (difference <= direct.error + fast.error).all()
    # 1e-6: both carry the bound of the fit of mu, 1e-10 of the gain, over up to 100 rad.
    assert fast.error.max() < 1e-6
    assert (direct.verdict == fast.verdict).all()


def test_bound_asked_for_is_the_bound_given(pair) -> None:
    # Law II needs the finest fit, and the Lebesgue constants multiply its bound; near defective multipliers,
    # a curve in the plane of speed and damping, the bound of a multiplier is larger than that of the matrix.
    law = pair.with_({"friction.law": "benedict_kelley"})
    axes = {"speed_rpm": np.linspace(2000.0, 20000.0, 100), "damping_ratio": np.linspace(0.0, 0.1, 20)}
    chart = stability_chart(law, axes, rtol=1e-8, method="chebyshev")
    assert float((chart.error > 1e-8).mean()) < 0.01


def test_interpolation_needs_speeds(pair) -> None:
    with pytest.raises(ParameterError, match="speed_rpm"):
        stability_chart(pair, {"damping_ratio": [0.0, 0.1]}, method="chebyshev")


@pytest.mark.parametrize("scale", [1e-9, 1e-6, 1e-3])
def test_disturbed_matrices_are_covered(pair, scale: float) -> None:
    # Noise that no polynomial can follow, unlike a smooth error: at the nodes it is part of the declared
    # errors; between them only the check at other points can see it.
    block = gear_block(pair)
    T = block.period * np.array([0.8, 1.2])
    turns = block.modal().omega.max() * (T[1] - T[0])

    def flow(t: np.ndarray, z: np.ndarray, declared: bool = True) -> FastMonodromy:
        clean = fast_monodromies(block, t, z)
        noise = np.random.default_rng(abs(hash((t.tobytes(), z.tobytes()))) % 2**32)
        E = noise.normal(size=clean.matrices.shape)
        E *= scale / np.linalg.norm(E, axis=(1, 2))[:, None, None]
        return FastMonodromy(clean.matrices + E, clean.errors + scale * declared)

    t, z = np.random.default_rng(2).uniform(*T, 40), np.linspace(0.0, 1.0, 40)
    exact = fast_monodromies(block, t, z).matrices
    errors = []
    for declared in (True, False):
        # Wanted no better than the noise allows: its coefficients do not decay.
        series = interpolant(
            lambda t, z, d=declared: flow(t, z, d), (T[0], T[1]), (0.0, 1.0), turns, 300 * scale
        )
        found = np.array([series(t[i : i + 1], z[i : i + 1])[0, 0] for i in range(40)])
        assert np.linalg.norm(found - exact, axis=(1, 2)).max() <= series.error
        errors.append(series.error)
    assert (
        errors[0] >= errors[1] + 0.99 * scale
    )  # what is declared at the nodes is added, times Lebesgue's >= 1


def test_feature_between_the_nodes_is_seen(pair) -> None:
    # The values at the nodes are those of the smooth flow, so the coefficients decay as they should; a bump
    # between them is found by the comparison at other points only.
    block = gear_block(pair)
    T = block.period * np.array([0.8, 1.2])
    turns = block.modal().omega.max() * (T[1] - T[0])
    asked: list[int] = []

    def flow(t: np.ndarray, z: np.ndarray) -> FastMonodromy:
        clean = fast_monodromies(block, t, z)
        asked.append(t.size)
        bump = 0.1 if len(asked) > 1 and t.size == 24 else 0.0
        return FastMonodromy(clean.matrices + bump, clean.errors)

    series = interpolant(flow, (T[0], T[1]), (0.0, 1.0), turns, 1e-8)
    assert asked[-1] == 24
    assert series.error >= 0.1 * 6  # Frobenius norm of a 6 x 6 matrix of 0.1


def test_too_long_a_range_is_refused(pair) -> None:
    block = gear_block(pair)
    with pytest.raises(NumericalError, match="nodes"):
        interpolant(lambda t, z: fast_monodromies(block, t, z), (1e-3, 2e-3), (0.0, 1.0), 1e6, 1e-8)

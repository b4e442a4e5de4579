"""Does the compiled kernel agree with the general engine, within the bound it reports, everywhere?"""

from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("flint", reason="needs python-flint (extra: test)")

from floquet import (
    RankOneSystem,
    fast_monodromies,
    fast_multipliers,
    gear_block,
    gear_pair_multipliers,
    scan,
    stability_chart,
)
from floquet.engine.many_multipliers import multipliers_of, quick_multipliers
from floquet.gear.axes import vary
from floquet.rank_one import batch
from floquet.rank_one.system import Gains
from lumped import load_gear_pair
from lumped.errors import NumericalError, ParameterError
from tests.floquet.engine.judge.enclosures import energy_monodromy, least_norm, real_balls


def random_system(rng: np.random.Generator) -> RankOneSystem:
    """Random rank-one feedback with jumps: m coordinates, P pieces, polynomials of degree up to 4."""
    m = int(rng.integers(1, 4))
    pieces = int(rng.integers(1, 5))
    degree = int(rng.integers(0, 5))
    phases = np.concatenate([[0.0], np.sort(rng.uniform(0.05, 0.95, pieces - 1)), [1.0]])
    metric = rng.uniform(0.5, 2.0, m)
    v = rng.normal(size=m)
    w = 0.3 * rng.normal(size=(pieces, m, degree + 1))
    w[:, :, 0] += rng.uniform(0.5, 2.0) * v / metric
    wd = 0.05 * rng.normal(size=(pieces, m, int(rng.integers(1, 4))))
    if rng.random() < 0.3:
        wd = rng.uniform(0.0, 0.1) * w  # damping proportional to stiffness, a case of its own in the kernel
    return RankOneSystem(
        stiffness=np.diag(rng.uniform(0.5, 4.0, m)), damping=np.diag(rng.uniform(-0.02, 0.2, m)), v=v,
        phases=phases, gains=Gains(w=w, wd=wd, fit_errors=np.zeros((pieces, 2))),
        period=float(10.0 ** rng.uniform(-0.5, 1.5)), metric=metric,
    )  # fmt: skip


def test_kernel_error_is_below_its_bound_on_random_systems() -> None:
    rng = np.random.default_rng(2024)
    for _ in range(12):
        system = random_system(rng)
        exact = energy_monodromy(system, system.period, 1.0, [1.0])
        for tolerance in (1e-2, 1e-4, 1e-7, 1e-13):
            fast = fast_monodromies(system, tolerance=tolerance)
            assert least_norm(exact - real_balls(fast.matrices[0])) <= fast.errors[0]


@pytest.mark.parametrize("axes", [
    {"speed_rpm": [900.0, 4000.0, 17000.0], "damping_ratio": [0.0, 0.02]},
    {"damping_ratio": [0.01, 0.05], "speed_rpm": [3000.0, 8000.0]},
    {"friction_coefficient": [0.0, 0.1], "speed_rpm": [1500.0, 4000.0, 16000.0]},
    {"torque": [30.0, 90.0], "damping_ratio": [0.03]},
    {"stiffness_variation": [0.0, 0.6, 1.3]},
    {"bearing_stiffness": [5e7, 4e8], "speed_rpm": [6000.0, 12000.0]},
])  # fmt: skip
@pytest.mark.parametrize(
    "law", ["coulomb", "benedict_kelley", "xu_kahraman", "smoothed_coulomb", "composite"]
)
def test_charts_of_both_routes_agree(law: str, axes: dict[str, list[float]]) -> None:
    pair = load_gear_pair("nasa_28_28").with_(friction__law=law)
    fast = stability_chart(pair, axes)
    slow = scan(lambda point: gear_pair_multipliers(vary(pair, point), method="gauss"), axes)
    assert fast.spectral_radius.dims == slow.spectral_radius.dims == tuple(axes)
    difference = np.abs(fast.spectral_radius - slow.spectral_radius)
    assert (difference <= fast.error + slow.error).all()
    assert fast.error.max() < 1e-8  # rtol = 1e-10 over up to 100 rad per cycle, times the conditioning
    assert (fast.verdict == slow.verdict).all()


def test_multipliers_do_not_feel_with_which_others_they_are_computed() -> None:
    # The eigenvectors of a nilpotent matrix of two entries are singular to the last digit; ten states are
    # more than the compiled eigenvalues take.
    rng = np.random.default_rng(0)
    M = np.concatenate([rng.normal(size=(3, 10, 10)), np.zeros((1, 10, 10))])
    defective = M[-1]
    defective[[0, 1], [1, 2]] = 1.0
    with pytest.raises(np.linalg.LinAlgError):
        np.linalg.inv(np.linalg.eig(defective)[1])
    errors = np.full(4, 1e-14)
    alone = multipliers_of(M[:3], errors[:3])
    together = multipliers_of(M, errors)
    assert np.array_equal(together.multipliers[:3], alone.multipliers)
    assert np.array_equal(together.errors[:3], alone.errors)


@pytest.mark.parametrize("kind", ["defective", "double", "diagonal", "zero", "rotation"])
def test_eigenvalue_kernel_in_awkward_cases(kind: str) -> None:
    block = {
        "defective": np.array([[0.5, 1.0, 0.0], [0.0, 0.5, 0.0], [0.0, 0.0, 0.1]]),
        "double": np.diag([0.5, 0.5, 0.1]), "diagonal": np.diag([3.0, 2.0, 1.0]), "zero": np.zeros((3, 3)),
        "rotation": np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]),
    }[kind]  # fmt: skip
    values, _, safe = quick_multipliers(block[None], np.array([1e-12]))
    exact = np.linalg.eigvals(block)
    assert np.abs(np.sort_complex(values[0]) - np.sort_complex(exact)).max() < 1e-7  # sqrt(eps) if defective
    assert bool(safe[0]) == (kind in ("diagonal", "rotation"))  # the others go to the careful bound


def test_radii_without_bounds_are_those_with_them() -> None:
    """Also where the kernel does not tell the multipliers apart, as of most motions below 400 rpm here."""
    system = gear_block(load_gear_pair("nasa_28_28"))
    periods = system.period * np.geomspace(0.02, 30.0, 80)
    flow = fast_monodromies(system, periods, tolerance=1e-11)
    assert np.unique(quick_multipliers(flow.matrices, flow.errors).safe).size == 2
    expected = np.abs(fast_multipliers(system, periods, tolerance=1e-11).multipliers).max(axis=1)
    radii = batch.spectral_radii(system, periods, 1.0, tolerance=1e-11)
    np.testing.assert_allclose(radii, expected, rtol=1e-10)
    near = expected > 0.95
    assert near.any()
    assert np.array_equal(radii[near], expected[near])  # searches decide there


def test_limits_are_reported() -> None:
    system = random_system(np.random.default_rng(3))
    with pytest.raises(NumericalError, match="Taylor steps"):
        fast_monodromies(system, [1e7 * system.period])
    unstable = replace(system, stiffness=-5.0 * np.eye(system.v.size) - system.stiffness)
    with pytest.raises(ParameterError, match="statically stable"):
        fast_monodromies(unstable)

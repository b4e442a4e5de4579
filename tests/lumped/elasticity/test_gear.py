"""Are elements exact, is a ring as stiff as Lame says, is a gear as accurate as its second mesh says?"""

import math
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest

from lumped import NumericalError
from lumped.cache import cached
from lumped.elasticity import blas
from lumped.elasticity import gear as module
from lumped.elasticity.elements import assembled, plane_law
from lumped.elasticity.gear import COARSE, FINE, PlaneGear, flank_compliance
from lumped.elasticity.ring import compliances
from lumped.gear_geometry.tooth_profile import ToothProfile

from .conftest import NU, TEETH, meshed


def test_error_falls_with_the_mesh_and_the_estimate_covers_it():
    teeth = 28
    profile = ToothProfile(teeth, 1.0, math.radians(20.0), 0.0, 1.25, 0.38)
    bore = profile.root_radius / 3.0
    lengths = np.array([2.4, 4.8, 6.6])
    by_size = {
        size: np.diag(compliances(meshed(profile, 0.0, bore, size), NU, teeth, lengths, 1, "free")[0])
        for size in (0.4, 0.2, 0.1)
    }
    steps = abs(by_size[0.4] - by_size[0.2]), abs(by_size[0.2] - by_size[0.1])
    # Quadratic elements: order 3 to 4 where the fields are smooth, less by the curvature under the load.
    assert np.log2(steps[0].sum() / steps[1].sum()) > 2.0
    gear = PlaneGear(profile, 15.0, bore, NU, "free", 1)
    fine, coarse = (flank_compliance(gear, size).deflection(lengths) for size in (FINE, COARSE))
    error = abs(fine - by_size[0.1])
    assert np.all(error < abs(fine - coarse))
    assert np.all(abs(fine - coarse) < 4e-3 * by_size[0.1])


def test_teeth_that_cannot_be_meshed_are_refused():
    profile = ToothProfile(28, 1.0, math.radians(20.0), 0.0, 1.25, 0.38)
    with pytest.raises(NumericalError, match="fold"):
        # A tip so far out that the flanks have crossed.
        flank_compliance(PlaneGear(profile, 18.0, 4.0, NU, "free", 1))


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setattr("lumped.cache.user_cache_path", lambda *_, **__: tmp_path)
    return tmp_path / "elasticity"


def test_results_are_cached_whole_or_not_at_all(folder):
    calls = []

    def compute():
        calls.append(None)
        return {"a": np.arange(3.0), "b": np.array(2.0)}

    def number_of_calls(inputs=b"gear"):
        arrays = cached("elasticity", [], inputs, compute)
        assert arrays["a"].tolist() == [0.0, 1.0, 2.0]
        assert arrays["b"] == 2.0
        return len(calls)

    with ThreadPoolExecutor(4) as pool:  # side by side
        list(pool.map(lambda _: number_of_calls(), range(8)))
    (file,) = folder.iterdir()
    calls.clear()
    assert number_of_calls() == 0
    assert number_of_calls(b"another gear") == 1
    content = file.read_bytes()
    for number, broken in enumerate(
        (b"", content[:-40], content[:200] + b"?" + content[201:], b"no file"), 2
    ):
        file.write_bytes(broken)
        assert number_of_calls() == number
    assert number_of_calls() == number
    for path in folder.iterdir():
        path.unlink()
    folder.rmdir()
    folder.write_text("no folder")
    assert number_of_calls() == number + 1


def test_a_changed_tooth_is_another_result(folder, monkeypatch):
    count = []
    monkeypatch.setattr(module, "compliances", lambda *a: count.append(1) or compliances(*a))
    profile = ToothProfile(12, 1.0, math.radians(20.0), 0.3, 1.25, 0.38)
    gear = PlaneGear(profile, 7.2, 1.0, NU, "clamped", 1)
    for one in (gear, replace(gear, support="free"), replace(gear, profile=replace(profile, fillet=0.3))):
        flank_compliance.__wrapped__(one)
        flank_compliance.__wrapped__(one)
    assert len(count) == 3


def test_what_is_cached_has_the_digits_that_this_process_would_compute(folder, monkeypatch):
    # Two threads of BLAS cut the sums of a product in another place than one; so does another processor.
    def cached_by(threads):
        monkeypatch.setenv("OPENBLAS_NUM_THREADS", threads)
        return float(cached("elasticity", [], b"gear", lambda: {"a": np.array(float(threads))})["a"])

    assert [cached_by("1"), cached_by("2"), cached_by("1")] == [1.0, 2.0, 1.0]


def threads():
    return [library.get() for library in blas.libraries()]


def test_blas_has_one_thread_while_it_solves_and_its_own_number_afterwards(monkeypatch):
    # Two threads take 3 to 30 times as long: the products of a factorization are small.
    libraries = blas.libraries()
    during = []
    assert len(libraries) == 2  # of numpy and of scipy

    def solve(*arguments):
        during.append(threads())
        raise NumericalError("no solution")

    monkeypatch.setattr(module, "compliances", solve)
    monkeypatch.setattr(module, "cached", lambda folder, sources, inputs, compute: compute())
    thread_counts = threads()
    for library in libraries:
        library.set(2)
    try:
        with pytest.raises(NumericalError, match="no solution"):
            flank_compliance.__wrapped__(
                PlaneGear(ToothProfile(12, 1.0, 0.35, 0.3, 1.25, 0.38), 7.2, 1.0, NU, "free", 1)
            )
        assert during == [[1, 1]]
        assert threads() == [2, 2]
    finally:
        for library, count in zip(libraries, thread_counts, strict=True):
            library.set(count)


LENGTHS = np.array([1.6, 3.2])


@pytest.fixture(scope="module")
def free(coarse):
    return compliances(coarse, NU, TEETH, LENGTHS, TEETH - 1, "free")


def test_load_and_point_may_change_places(free):
    # Load at i on a tooth and point at j on the next one, or the other way round. Only the load's singularity
    # is taken off, so the two differ by an error of the mesh, beside a motion of the loaded tooth of 2 to 4.
    assert free[1] == pytest.approx(free[-1].T, abs=4e-4)


def test_uniform_strain_meets_no_resistance_inside_and_the_area_is_the_mass(coarse):
    matrix, heavy = assembled(coarse.nodes, coarse.elements, NU)
    strain = np.array([[0.3, 0.7], [-0.2, 0.5]])
    displacement = (coarse.nodes @ strain.T).ravel()
    force = (matrix @ displacement).reshape(-1, 2)
    border = np.unique(np.concatenate([coarse.surface.ravel(), coarse.behind, coarse.ahead, coarse.bore]))
    inside = np.setdiff1d(np.arange(len(coarse.nodes)), border)
    assert abs(force[inside]).max() < 1e-12
    # The work of uniform stress is the energy density times the area.
    area = heavy[::2, 0].sum()
    voigt = np.array([0.3, 0.5, 0.5])
    assert displacement @ force.ravel() == pytest.approx(voigt @ plane_law(NU) @ voigt * area, rel=1e-12)
    ends = coarse.nodes[coarse.surface[:, [0, 2]]]
    polygon = 0.5 * (ends[:, 0, 0] * ends[:, 1, 1] - ends[:, 1, 0] * ends[:, 0, 1]).sum()
    bore = 0.5 * math.hypot(*coarse.nodes[coarse.bore[0]]) ** 2 * 2.0 * math.pi / TEETH
    assert area == pytest.approx(polygon - bore, rel=3e-3)  # edges are curved


def test_the_ring_twists_as_lame_says(small):
    # The same load on every tooth is a pure torque. Between two bores only the twist of the ring differs:
    # z r_b^2 (1/r_1^2 - 1/r_2^2)/(4 pi G), up to what the teeth feel of the bore, (1/h)^z.
    bores = small.root_radius / np.array([3.0, 6.0])
    lengths = np.array([2.0])
    wide_bore, narrow_bore = (
        compliances(meshed(small, 0.5, bore, 0.3), NU, TEETH, lengths, TEETH - 1, "clamped").sum()
        for bore in bores
    )
    shear = 0.5 / (1.0 + NU)
    lame = TEETH * small.base_radius**2 * (bores[1] ** -2 - bores[0] ** -2) / (4.0 * math.pi * shear)
    assert narrow_bore - wide_bore == pytest.approx(lame, rel=5e-4)

"""Do the bounds on the gains of the mesh hold for what they allow for: friction, varied stiffness, breaks?

Each piece is looked at between and at its ends; where the worst is attained a bound is hardly more than it.
"""

import numpy as np
import pytest

from floquet.gear.axes import GearVariation
from floquet.gear.gains import MeshGains, _slips
from floquet.gear.multipliers import feedback_system
from tests.unlike_pairs import unlike_pair

PAIRS = (
    "rack_25_degrees_always_pushing",
    "larger_gear_drives_contact_lost",
    "contact_ratio_1_1_large_shifts",
)
#: Number of the first gain by mu, where levels of mu are given: stiffness and damping stand before it.
BY_MU = 2
NODES = np.concatenate([[-1.0, 1.0], np.cos(np.pi * (np.arange(40) + 0.5) / 40)])


def mesh_of(name: str, factor: float = 1.0, error: float = 0.0, levels: tuple[float, ...] = ()) -> MeshGains:
    """The gains of an unlike pair under prescribed contact, its friction wrong by so much at most."""
    pair = unlike_pair(name).with_(
        {
            "mesh.contact": "prescribed", "mesh.stiffness": {"model": "parabolic"},
            "mesh.damping_ratio": 0.03, "friction.law": "coulomb", "friction.coefficient": 0.06,
        }
    )  # fmt: skip
    feedback = feedback_system(GearVariation(pair, supports="springs"))
    misfit = np.full(feedback.misfit.shape, error)
    return MeshGains(feedback.system, feedback.metric, misfit, factor, levels)


def total_stiffness(mesh: MeshGains) -> np.ndarray:
    """Stiffness of all tooth pairs together at NODES of every segment."""
    centre, half, segment = whole_segments(mesh)
    phases = mesh.pitch * (centre[:, None] + half[:, None] * NODES)
    return np.asarray(sum(mesh.k(offset + phases, i, segment) for i, offset in enumerate(mesh.offsets)))


def whole_segments(mesh: MeshGains) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Middles, half lengths and numbers of all segments."""
    return 0.5 * (mesh.edges[1:] + mesh.edges[:-1]), 0.5 * np.diff(mesh.edges), np.arange(mesh.edges.size - 1)


@pytest.mark.parametrize("levels", [(), (0.05, 0.01)])
@pytest.mark.parametrize("name", PAIRS)
def test_an_error_of_friction_is_in_the_bound(name: str, levels: tuple[float, ...]) -> None:
    """mu of each tooth pair off by e, with the signs that add up: sum of k e |arm| in the metric."""
    e = 1e-3
    mesh = mesh_of(name, error=e, levels=levels)
    sure = mesh_of(name, levels=levels)
    centre, half, segment = whole_segments(mesh)
    _, _, with_errors = mesh(centre, half, segment, NODES)
    _, _, without_errors = sure(centre, half, segment, NODES)
    declared = with_errors - without_errors
    part = BY_MU if levels else 0
    phases = centre[:, None] + half[:, None] * NODES
    for j, law in enumerate((mesh.k, mesh.c)):
        worst = np.zeros(phases.shape)
        for i, offset in enumerate(mesh.offsets):
            xi = offset + mesh.pitch * phases
            arm = mesh.arm[0] + xi[..., None] * mesh.arm[1]
            worst += np.abs(law(xi, i, segment)) * e * np.sqrt(np.square(arm) @ mesh.metric)
        worst = worst.max(axis=1)
        assert (worst <= declared[part + j] * (1.0 + 1e-9)).all()
        # Laws count by the sum of the moduli of their terms, arms at the farthest place and by their parts.
        assert (declared[part + j] < 25.0 * worst).all()


@pytest.mark.parametrize("least", [0.9, 0.1, 0.01])
@pytest.mark.parametrize("name", PAIRS)
def test_polynomials_in_place_of_a_varied_stiffness_are_as_near_as_is_said(name: str, least: float) -> None:
    """k_i (mean + factor (k - mean))/k, and c_i by its root, of degree 8 over whole segments.

    With a factor that leaves so much of the mean where the stiffness is least: near 0 the root is steep.
    """
    plain = mesh_of(name)
    centre, half, segment = whole_segments(plain)
    total = total_stiffness(plain)
    factor = (1.0 - least) * plain.mean / (plain.mean - total.min())
    mesh = mesh_of(name, factor)
    f = (mesh.mean + factor * (total - mesh.mean)) / total
    values, errors, fixed = mesh(centre, half, segment, NODES)
    loads, _, _ = plain(centre, half, segment, NODES)
    loose = []
    for j, exact in enumerate((f, np.sqrt(f))):
        error = np.sqrt(np.square(values[j] - exact[..., None] * loads[j]) @ mesh.metric).max(axis=1)
        assert (error <= errors[j] + fixed[j]).all()
        loose += [errors[j, k] / error[k] for k in range(error.size) if error[k] > 1000.0 * fixed[j, k]]
    # A residual by the sum of the moduli of its terms, over the least stiffness or the least root.
    assert all(ratio < 3.0 for ratio in loose)
    assert loose or least > 0.01


@pytest.mark.parametrize("levels", [(), (1e-9, 1e-9)])
@pytest.mark.parametrize("name", PAIRS)
def test_a_moved_break_changes_the_gain_by_no_more_than_is_said(name: str, levels: tuple[float, ...]) -> None:
    """For as long as a break is off the gain is that of the neighbour: the jump times the slip.

    Of the gain by mu it is twice the modulus at the pitch point, where the friction turns, and all of it
    where a tooth pair leaves.
    """
    mesh = mesh_of(name, levels=levels)
    ends = mesh(*whole_segments(mesh), np.array([-1.0, 1.0]))[0]
    assert (mesh.slips > 0.0).all()
    for law in (mesh.k, mesh.c, mesh.mu):  # a tooth pair that leaves counts on the side where it is gone
        assert (law.near[:, :-1] >= law.size).all()
        assert (law.near[:, 1:] >= law.size).all()
    bound = mesh.jumps / mesh.slips
    assert (bound[:, -1] == bound[:, 0]).all()  # of both ends of the period
    before = np.roll(ends[:, :, 1], 1, axis=1)
    jump = np.sqrt(np.square(before - ends[:, :, 0]) @ mesh.metric)
    assert (jump <= bound[:, :-1] * (1.0 + 1e-12)).all()
    if levels:  # laws count by the moduli of their terms, arms by their parts and at the farthest place
        bound_by_mu = bound[BY_MU]
        jump_by_mu = jump[BY_MU]
        assert bound_by_mu.max() < 30.0 * jump_by_mu.max()


@pytest.mark.parametrize("name", PAIRS)
def test_a_moved_break_of_a_varied_stiffness_changes_the_gain_by_no_more_than_is_said(name: str) -> None:
    """By a factor that leaves 2 % of the mean where the stiffness is least.

    With a contact ratio of 1.1 the mean is near the stiffness of one tooth pair. Where a second one touches,
    at the start of the period, the total then jumps by more than twice what both have without the variation.
    """
    plain = mesh_of(name)
    mesh = mesh_of(name, 0.98 * plain.mean / (plain.mean - total_stiffness(plain).min()))
    values = mesh(*whole_segments(mesh), np.array([-1.0, 1.0]))[0]
    before = np.roll(values[:, :, 1], 1, axis=1)
    jump = np.sqrt(np.square(before - values[:, :, 0]) @ mesh.metric)
    bound = mesh.jumps / mesh.slips
    assert (jump <= bound[:, :-1]).all()
    # Each side counts by the moduli of its terms, with the larger factor of both.
    assert (bound[:, 0] < 10.0 * jump[:, 0]).all()


def test_each_break_is_within_the_slip_of_its_edge() -> None:
    """Several breaks for one edge: the farthest counts, and those of 0 count at the end of the period too."""
    edges = np.array([0.0, 0.25, 0.5, 1.0])
    raw = np.array([3e-13, 0.25 - 1e-13, 0.25 + 4e-13, 0.25, np.nextafter(0.5, 1.0), 1.0 - 2e-13])
    slips = _slips(raw, edges, 1e-16)
    assert slips - 1e-16 == pytest.approx([3e-13, 4e-13, 2.0**-53, 3e-13], rel=1e-3, abs=0.0)

"""Are coincident multipliers proven to be on the unit circle where Krein's signatures say so, and only there?

Judges: first-order theory of combination resonances (Krein 1950; Yakubovich and Starzhinskii 1975, chapter
III; Hsu 1963), and multipliers with 77 digits (Arb) of piecewise constant systems.
"""

import numpy as np
import pytest

from floquet import from_second_order, monodromy, scan
from floquet.engine.multipliers import Cluster, clusters_of
from floquet.engine.neutral import SkewForm, definite_signatures, skew_form
from tests.evidence.floquet.neutral_counts import Count, count_hill, hill_systems
from tests.floquet.engine.test_neutral import COUPLING, OMEGA, hill

NEARLY_NOTHING = (0.0, 1e-13, 1e-12, 1e-11, 1e-10, 1e-9)


@pytest.mark.parametrize("modes", [(0, 1), (0, 2), (1, 2)])
def test_at_differences_multipliers_coincide_and_are_neutral_and_at_sums_they_are_not(modes) -> None:
    """At a difference two multipliers of one sign meet, at a sum and at 2 omega/k two of opposite signs."""
    i, j = modes
    difference, total = OMEGA[j] - OMEGA[i], OMEGA[j] + OMEGA[i]
    for strength in NEARLY_NOTHING:
        assert monodromy(hill(difference, strength)).verdict == "neutral"
        assert monodromy(hill(difference / 2.0, strength)).verdict == "neutral"
        for place in (total, 2.0 * OMEGA[i]):
            assert monodromy(hill(place, strength)).verdict in ("undecided", "unstable")
    assert monodromy(hill(total, 1e-9)).verdict == "unstable"


def test_disks_that_meet_decide_nothing_without_signatures() -> None:
    """The verdict at a difference is by signatures: the disks of these multipliers do meet."""
    spectrum = monodromy(hill(OMEGA[1] - OMEGA[0], 1e-12))
    values, errors = spectrum.multipliers, spectrum.multiplier_errors
    apart = np.abs(values[:, None] - values) - errors[:, None] - errors
    assert (apart[~np.eye(6, dtype=bool)] < 0.0).any()
    assert spectrum.neutral


def test_damping_makes_a_coincidence_stable_and_a_circulatory_force_takes_the_proof_away() -> None:
    difference = OMEGA[1] - OMEGA[0]
    assert monodromy(hill(difference, 1e-10, damping=1e-4)).verdict == "stable"
    friction = COUPLING.copy()
    friction[0, 1] = -friction[1, 0]
    for strength in (1e-12, 1e-10, 1e-8):
        driven = monodromy(hill(difference, strength, friction))
        assert (driven.neutral, driven.symplectic) == (False, False)
        assert driven.verdict in ("undecided", "unstable")
    assert monodromy(hill(difference, 1e-8, friction)).verdict == "unstable"  # a difference tongue


def test_gyroscopic_forms_and_masses_are_in_the_form() -> None:
    """Two equal gyroscopic pairs, and masses that differ by 1e6.

    x'' + 2 x - 0.4 y' = 0, y'' + 2 y + 0.4 x' = 0 is bounded by its energy: definite K.
    """
    G = np.zeros((4, 4))
    G[0, 1] = G[2, 3] = -0.4
    twice = monodromy(from_second_order(np.eye(4), G - G.T, 2.0 * np.eye(4), 1.3))
    assert twice.verdict == "neutral"
    assert (
        monodromy(from_second_order(np.eye(2), [[0.0, 2.0], [-2.0, 0.0]], -np.eye(2), 1.3)).verdict
        != "neutral"
    )
    masses = np.diag([1e-3, 1e3, 1.0, 1.0])
    mixed = monodromy(from_second_order(masses, np.zeros((4, 4)), 2.0 * masses, 1.0))
    assert mixed.verdict == "neutral"


def test_a_chart_uses_signatures_too() -> None:
    difference = OMEGA[1] - OMEGA[0]
    axes = {"strength": [1e-12, 1e-10], "frequency": [difference, OMEGA[0] + OMEGA[1]]}
    chart = scan(lambda at: hill(at["frequency"], at["strength"]), axes)
    assert (chart["verdict"].values[:, 0] == 2).all()
    assert (chart["verdict"].values[:, 1] != 2).all()


def test_a_judge_with_77_digits_contradicts_no_verdict_of_100_systems() -> None:
    """At resonances, with strengths from 1e-13 to 0.03: most multipliers nearly coincide."""
    counts = {place: count_hill(25, place) for place in ("sum", "difference", "twice one", "anywhere")}
    assert sum(one.wrong for one in counts.values()) == 0
    assert counts["difference"].verdicts["neutral"] == 25
    assert counts["sum"].verdicts["unstable"] > 15
    assert counts["twice one"].verdicts["unstable"] > 15


def test_the_judge_sees_a_wrong_verdict() -> None:
    """At a sum the judge finds multipliers off the circle, and a count of such a neutral verdict is wrong."""
    (system,) = hill_systems(1, "sum")
    strong = system._replace(half=system.half * 1e-3 / np.abs(system.half).max())
    assert strong.distance_from_circle > 1e-6
    assert strong._replace(half=0.0 * system.half).distance_from_circle < 1e-60
    count = Count("one", "Arb")
    count.add("neutral", True)
    count.add("unstable", False)
    count.add("undecided", True)
    assert count.wrong == 2


def tilted(angle: float, tilt: float) -> Cluster:
    """A cluster of one vector cos(angle) e+ + sin(angle) e-, where i J is +1 on e+ and -1 on e-."""
    plus, minus = np.array([1.0, -1.0j]) / np.sqrt(2.0), np.array([1.0, 1.0j]) / np.sqrt(2.0)
    vector = np.cos(angle) * plus + np.sin(angle) * minus
    return Cluster([0], np.ones((1, 1), dtype=complex), 0.0, vector[:, None], tilt)


def test_a_subspace_that_the_errors_can_turn_until_the_form_is_zero_is_not_definite(monkeypatch) -> None:
    """The nearest vector with form 0 is cos 45 e+ + sin 45 e-, at the distance sin(45 - angle)."""
    form = SkewForm.exact(skew_form(1))
    for angle in (0.0, 0.3, 0.7):
        distance = np.sin(0.25 * np.pi - angle)
        for share, definite in ((1.0, False), (0.3, True)):
            cluster = tilted(angle, share * distance)
            monkeypatch.setattr("floquet.engine.neutral.clusters_of", lambda M, delta, one=cluster: [one])
            assert definite_signatures(np.eye(2), 0.0, form) == definite


@pytest.mark.parametrize("error_of_form", [0.0, 0.2])
def test_an_error_of_the_form_counts(error_of_form: float, monkeypatch) -> None:
    form = SkewForm(skew_form(1), error_of_form * np.abs(skew_form(1)))
    angle = 0.5 * np.arccos(0.15)  # the form of the vector is 0.15
    monkeypatch.setattr("floquet.engine.neutral.clusters_of", lambda M, delta: [tilted(angle, 0.0)])
    assert definite_signatures(np.eye(2), 0.0, form) == (error_of_form == 0.0)


def test_invariant_subspaces_of_wrong_matrices_are_as_near_as_the_tilt_says() -> None:
    """Random matrices with a double multiplier, changed by errors of the norm delta."""
    rng = np.random.default_rng(5)
    nearest = 0.0
    for _ in range(60):
        V = rng.normal(size=(4, 4))
        M = V @ np.diag([1.0, 1.0, rng.uniform(-0.5, 0.9), -1.2]) @ np.linalg.inv(V)
        delta = 10.0 ** rng.uniform(-9.0, -3.0)
        E = rng.normal(size=(4, 4))
        E *= delta / np.linalg.norm(E)
        for cluster in clusters_of(M, delta):
            if not np.isfinite(cluster.tilt) or len(cluster.members) == 4:
                continue
            values, vectors = np.linalg.eig(M + E)
            centre = np.diagonal(cluster.block).mean()
            chosen = vectors[:, np.argsort(np.abs(values - centre))[: len(cluster.members)]]
            Q = np.linalg.qr(chosen)[0]
            apart = np.linalg.norm(cluster.basis - Q @ (Q.conj().T @ cluster.basis), 2)
            assert apart <= cluster.tilt + 1e-12
            nearest = max(nearest, apart / cluster.tilt)
    assert nearest > 0.1

"""Is the stability of systems without damping proven, and proven only where it is true?

Judges: characteristic values of Mathieu's equation by scipy, Meissner's trace, closed forms of constant
systems, Krein's signatures, and multipliers with 77 digits (`tests/floquet/engine/judge`).
"""

import itertools

import numpy as np
import pytest
from scipy.special import mathieu_a, mathieu_b

from floquet import (
    FourierSeries,
    PeriodicMatrix,
    PeriodicSystem,
    PiecewisePolynomial,
    Spectrum,
    from_second_order,
    monodromy,
    scan,
)
from floquet.engine.neutral import on_unit_circle, separate_from_mirror_images, skew_form
from tests.evidence.floquet.reference_systems import mathieu_unstable, meissner_trace

COUPLING = np.array([[1.0, 0.5, -0.3], [0.5, -0.8, 0.6], [-0.3, 0.6, 0.4]])
OMEGA = np.array([1.0, 1.7, 3.1])


def mathieu(a: float, q: float, c: float = 0.0) -> PeriodicSystem:
    """x'' + c x' + (a - 2 q cos 2t) x = 0."""
    return from_second_order(1.0, c, PeriodicMatrix(a, (FourierSeries(np.pi, 0.0, [1.0]), -2.0 * q)), np.pi)


def hill(frequency: float, strength: float, coupling=COUPLING, damping=0.0, **options) -> PeriodicSystem:
    """Three modes with the frequencies OMEGA, coupled by strength times cos(frequency t)."""
    period = 2.0 * np.pi / frequency
    stiffness = PeriodicMatrix(np.diag(OMEGA**2), (FourierSeries(period, 0.0, [1.0]), strength * coupling))
    C = options.get("C", damping * np.eye(3))
    return from_second_order(np.eye(3), C, stiffness, period)


def test_every_stable_node_of_mathieu_is_neutral_and_every_other_node_is_unstable() -> None:
    """But for nodes within 1e-6 of a characteristic value, where |trace| - 2 is some 1e-10."""
    axes = {"a": np.linspace(-0.4, 9.7, 60), "q": np.linspace(0.05, 4.0, 12)}
    chart = scan(lambda at: mathieu(at["a"], at["q"]), axes)
    assert chart.attrs["certificate"] == "proven"
    stable_nodes = 0
    for j, q in enumerate(axes["q"]):
        unstable, edges = mathieu_unstable(axes["a"], q)
        sure = np.abs(axes["a"][:, None] - edges).min(axis=1) > 1e-6
        assert (chart["verdict"].values[sure, j] == np.where(unstable, -1, 2)[sure]).all()
        stable_nodes += int((sure & ~unstable).sum())
    assert stable_nodes > 300
    assert chart["verdict"].attrs["flag_meanings"].split() == ["unstable", "undecided", "stable", "neutral"]


@pytest.mark.parametrize("q", [0.7, 3.0])
@pytest.mark.parametrize(
    ("m", "edge", "outward"), [(1, mathieu_b, -1.0), (1, mathieu_a, 1.0), (2, mathieu_b, -1.0)]
)
def test_both_sides_of_an_edge_are_proven_and_the_edge_itself_is_not(q, m, edge, outward) -> None:
    """|trace| - 2 changes by some units per unit of a: 1e-7 is far above the bound of 1e-10."""
    value = float(edge(m, q))
    assert monodromy(mathieu(value + outward * 1e-7, q)).verdict == "neutral"
    assert monodromy(mathieu(value - outward * 1e-7, q)).verdict == "unstable"
    at_edge = monodromy(mathieu(value, q))
    assert at_edge.verdict == "undecided"
    assert "boundary" in at_edge.verdict_words


def test_meissners_closed_form_decides_as_the_proof_does() -> None:
    seen = set()
    for delta, part in itertools.product(np.linspace(0.15, 6.0, 14), (0.1, 0.5, 0.9)):
        jump = PiecewisePolynomial([0.0, 1.0, 2.0], [[part * delta], [-part * delta]])
        result = monodromy(from_second_order(1.0, 0.0, PeriodicMatrix(delta, (jump, 1.0)), 2.0))
        trace = abs(meissner_trace(delta, part * delta, 2.0))
        assert abs(trace - 2.0) > 1e-6
        assert result.verdict == ("neutral" if trace < 2.0 else "unstable")
        seen.add(result.verdict)
    assert seen == {"neutral", "unstable"}


def signature(matrix: np.ndarray, place: complex) -> float:
    """Krein's sign of i x^H J x for the eigenvector x of the multiplier next to a place."""
    values, vectors = np.linalg.eig(matrix)
    x = vectors[:, np.abs(values - place).argmin()]
    return float(np.sign((1j * x.conj() @ skew_form(len(matrix) // 2) @ x).real))


def test_combination_resonances_are_those_of_krein() -> None:
    """Symmetric coupling: sums of frequencies are unstable, differences are neutral.

    At a sum two multipliers of opposite sign meet, at a difference two of the same sign (Krein 1950;
    Yakubovich and Starzhinskii 1975, chapter III). 1.0004: second order, within the tongue of width 0.02.
    """
    for i, j in ((0, 1), (0, 2), (1, 2)):
        total, difference = OMEGA[j] + OMEGA[i], OMEGA[j] - OMEGA[i]
        at_sum = monodromy(hill(total, 0.12))
        assert (at_sum.verdict, at_sum.symplectic) == ("unstable", True)
        assert monodromy(hill(difference, 0.02)).verdict == "neutral"
        # Almost without coupling, beside the resonance: which multipliers would meet there, of which signs?
        for frequency, sign_of_first in ((1.01 * difference, 1.0), (1.01 * total, -1.0)):
            first, second = np.exp(2j * np.pi / frequency * np.array([sign_of_first * OMEGA[i], OMEGA[j]]))
            assert abs(first - second) < 0.1
            matrix = monodromy(hill(frequency, 1e-6)).matrix
            assert signature(matrix, first) == sign_of_first * signature(matrix, second)


def test_damping_makes_a_neutral_system_stable_and_a_circulatory_force_does_not() -> None:
    frequency = OMEGA[1] - OMEGA[0]
    assert monodromy(hill(frequency, 0.05)).verdict == "neutral"
    damped = monodromy(hill(frequency, 0.05, damping=1e-4))
    assert (damped.verdict, damped.symplectic) == ("stable", False)
    friction = COUPLING.copy()
    friction[0, 1] = -friction[1, 0]  # d_12 d_21 < 0: a difference tongue (Hsu 1963)
    driven = monodromy(hill(frequency, 0.05, friction))
    assert (driven.verdict, driven.symplectic) == ("unstable", False)
    for speed in np.linspace(
        1.1, 5.0, 7
    ):  # multipliers on the circle within their bounds, but nothing says why
        assert monodromy(hill(speed, 1e-3, friction)).verdict in ("undecided", "unstable")


def test_a_hair_of_asymmetry_or_of_damping_takes_the_proof_away() -> None:
    frequency = 2.2
    for change in (np.nextafter(0.5, 1.0), 0.5 + 1e-13):
        one_sided = COUPLING.copy()
        one_sided[0, 1] = change
        assert monodromy(hill(frequency, 0.05, one_sided)).verdict == "undecided"
    assert monodromy(hill(frequency, 0.05, damping=1e-15)).verdict == "undecided"
    assert monodromy(hill(frequency, 0.05, damping=-1e-15)).verdict == "undecided"
    M = np.array([[1.0, 0.1], [0.1 + 1e-15, 1.0]])
    assert not from_second_order(M, np.zeros((2, 2)), np.eye(2), 1.0).symplectic
    # Of a callable only samples are known.
    assert monodromy(PeriodicSystem(lambda t: [[0.0, 1.0], [-2.0, 0.0]], 1.0)).verdict == "undecided"
    assert monodromy(hill(frequency, 0.05), method="gauss").verdict == "undecided"


@pytest.mark.parametrize(("gyroscopic", "verdict"), [(2.1, "neutral"), (1.9, "unstable")])
def test_gyroscopic_moments_stabilise_as_the_closed_form_says(gyroscopic: float, verdict: str) -> None:
    """x'' - x + g y' = 0, y'' - y - g x' = 0 is stable for g > 2 (Thomson and Tait), by no energy."""
    G = np.array([[0.0, gyroscopic], [-gyroscopic, 0.0]])
    result = monodromy(from_second_order(np.eye(2), G, -np.eye(2), 1.3))
    assert result.verdict == verdict
    squares = np.roots([1.0, gyroscopic**2 - 2.0, 1.0])
    exponents = np.concatenate([np.sqrt(squares + 0j), -np.sqrt(squares + 0j)])
    for multiplier in np.exp(1.3 * exponents):
        assert np.abs(result.multipliers - multiplier).min() < 1e-9
    wobbling = PeriodicMatrix(np.zeros((2, 2)), (FourierSeries(1.3, 1.0, [0.1]), G))
    assert not from_second_order(np.eye(2), wobbling, -np.eye(2), 1.3).symplectic  # G(t): K needs a part G'/2


def test_first_order_systems_are_neutral_by_their_matrices() -> None:
    """Two states: trace 0. Four: J A symmetric; the same system in other coordinates is not proven."""
    wave = FourierSeries(2.0, 0.0, [1.0])
    two = PeriodicMatrix([[0.3, 1.0], [-2.0, -0.3]], (wave, [[0.1, 0.2], [-0.3, -0.1]]))
    assert monodromy(PeriodicSystem(two, 2.0)).verdict == "neutral"
    drifting = PeriodicMatrix([[0.3, 1.0], [-2.0, -0.3 + 1e-16]], (wave, [[0.1, 0.2], [-0.3, -0.1]]))
    assert monodromy(PeriodicSystem(drifting, 2.0)).verdict == "undecided"
    S = np.array([[3.0, 0.2, 0.1, 0.4], [0.2, 5.0, 0.3, 0.1], [0.1, 0.3, 1.0, 0.2], [0.4, 0.1, 0.2, 1.0]])
    A = np.linalg.inv(skew_form(2)) @ S
    four = PeriodicSystem(PeriodicMatrix(A, (wave, 0.1 * A @ np.diag([1.0, 1.0, 1.0, 1.0]))), 2.0)
    assert monodromy(four).verdict == "neutral"
    order = [0, 2, 1, 3]
    assert not PeriodicSystem(PeriodicMatrix(A[np.ix_(order, order)]), 2.0).symplectic
    assert not PeriodicSystem(PeriodicMatrix(np.zeros((3, 3))), 2.0).symplectic


def test_equal_oscillators_are_neutral_and_a_free_mass_is_not() -> None:
    """Two equal oscillators are bounded, by signatures; x'' = 0 is not: its multipliers 1 are defective."""
    equal = monodromy(from_second_order(np.eye(2), np.zeros((2, 2)), 2.0 * np.eye(2), 1.0))
    free = monodromy(from_second_order(1.0, 0.0, 0.0, 1.0))
    two_free = monodromy(from_second_order(np.eye(2), np.zeros((2, 2)), np.diag([0.0, 2.0]), 1.0))
    assert (equal.verdict, free.verdict, two_free.verdict) == ("neutral", "undecided", "undecided")
    assert free.verdict_words == two_free.verdict_words != "undecided"


def quadruple(modulus: float, angle: float) -> np.ndarray:
    """Four multipliers of a symplectic matrix that are off the unit circle."""
    each = modulus * np.exp(1j * angle)
    return np.array([[each, each.conjugate(), 1.0 / each.conjugate(), 1.0 / each]])


def test_disks_count_with_their_mirror_images() -> None:
    """Off the circle by 1e-6: radii of 0.4e-6 part the disks, but each mirror image meets another disk."""
    values = quadruple(1.0 + 1e-6, 0.7)
    for radius in (1e-9, 0.4e-6, 0.9e-6, 1e-2):
        assert not separate_from_mirror_images(values, np.full((1, 4), radius))[0]
    on_circle = np.exp(1j * np.array([[0.7, -0.7, 1.4, -1.4]]))
    for radius, separate in ((0.3, True), (0.36, False)):  # the distances are 2 sin 0.35 = 0.686 and more
        assert separate_from_mirror_images(on_circle, np.full((1, 4), radius))[0] == separate
    # The mirror image of the disk 0.5 +- 0.1 is 2.08 +- 0.42, which reaches 1.9 but not 2.7.
    for other, separate in ((1.9, False), (2.7, True)):
        values, radii = np.array([[0.5, other]], dtype=complex), np.array([[0.1, 1e-3]])
        assert separate_from_mirror_images(values, radii)[0] == separate
    # The mirror image of 3 +- 0.5 is 0.343 +- 0.057, which does not reach 0.5; 0.343 +- 0.5 would.
    values, radii = np.array([[3.0, 0.5]], dtype=complex), np.array([[0.5, 0.01]])
    assert separate_from_mirror_images(values, radii)[0]
    assert not separate_from_mirror_images(np.array([[0.1, 5.0]], dtype=complex), np.array([[0.2, 0.1]]))[0]


def test_the_error_of_the_trace_is_attained() -> None:
    """E = delta I/sqrt 2 has the Frobenius norm delta and the trace sqrt 2 delta."""
    angle = 1e-3
    M = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])[None]
    room = (2.0 - 2.0 * np.cos(angle)) / np.sqrt(2.0)
    values, errors = np.linalg.eigvals(M), np.zeros((1, 2))
    assert on_unit_circle(M, np.array([0.99 * room]), values, errors)[0]
    assert not on_unit_circle(M, np.array([1.01 * room]), values, errors)[0]


def test_the_verdict_of_a_spectrum_without_a_proof_is_as_before() -> None:
    spectrum = Spectrum(np.array([1.0 + 0j]), np.array([1e-9]), 1.0)
    assert (spectrum.verdict, spectrum.verdict_words, spectrum.neutral) == ("undecided", "undecided", False)


def test_a_refined_chart_of_neutral_nodes_evaluates_its_edges_alone() -> None:
    """Of a neutral box |radius - 1| is rounding: it must not ask for smaller boxes."""
    axes = {"a": np.linspace(0.2, 3.6, 65), "q": np.linspace(0.02, 0.8, 17)}
    chart = scan(lambda at: mathieu(at["a"], at["q"]), axes, refine=True)
    full = scan(lambda at: mathieu(at["a"], at["q"]), axes)
    assert (chart["verdict"] == full["verdict"]).all()
    assert set(np.unique(chart["verdict"])) == {-1, 2}
    assert float(chart["known"].mean()) < 0.9

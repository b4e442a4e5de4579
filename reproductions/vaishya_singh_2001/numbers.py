"""The numbers behind the statements, each of one gear pair; statements.toml has their definitions."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from itertools import pairwise

import numpy as np
from scipy.special import jv

import floquet
from floquet import FourierSeries, LinearSegments, PeriodicMatrix, PeriodicSystem
from lumped.model.results import farthest_reversal
from lumped.typing import FloatArray
from reproductions.vaishya_singh_2001.gears import MU, Gears, without_force_of_friction

#: Mesh frequency over the natural frequency of statements about a motion: no order is near its resonance.
_AWAY = 0.37
#: Harmonics of a truncated Fourier series.
_HARMONICS = 3


def friction_alone(gears: Gears) -> float:
    """Peak to peak of the motion by the friction of the mean load alone, over the mean deflection."""
    segments = gears.at_ratio(_AWAY).closed_form(friction_load="mean")
    mean = without_force_of_friction(segments)
    alone = replace(segments, force_start=segments.force_start - mean, force_end=segments.force_end - mean)
    time = segments.period * np.arange(1024) / 1024
    return float(np.ptp(alone.motion(time).dte) / segments.motion(time).dte.mean())


def meissner(gears: Gears) -> float:
    """Distance of the multipliers without friction from those of cosines and sines of every segment."""
    model = gears.at_ratio(_AWAY, mu=0.0)
    pieces = gears.at_ratio(_AWAY).closed_form(friction_load="mean")
    matrix = np.eye(2)
    for k, c, length in zip(pieces.stiffness_start, pieces.damping, np.diff(pieces.edges), strict=True):
        matrix = _harmonic(k / model.mass, 0.5 * c / model.mass, length) @ matrix
    return _distance(np.linalg.eigvals(matrix), model.multipliers.multipliers)


def bessel(gears: Gears) -> float:
    """Distance of the multipliers from those of Bessel functions of the order 1/3, without damping."""
    model = gears.at_ratio(_AWAY, damping=0.0)
    pieces = model.closed_form()
    matrix = np.eye(2)
    for start, end, length in zip(
        pieces.stiffness_start, pieces.stiffness_end, np.diff(pieces.edges), strict=True
    ):
        a, b = start / model.mass, (end - start) / model.mass / length
        flat = abs(b * length) < 1e-9 * a
        matrix = (_harmonic(a, 0.0, length) if flat else _bessel(a, b, length)) @ matrix
    return _distance(np.linalg.eigvals(matrix), model.multipliers.multipliers)


def slope(gears: Gears) -> float:
    """Largest change of k between two switches by arms that move, over the mean of k."""
    pieces = gears.at_ratio(_AWAY).closed_form(damper_friction=False)
    return float(np.abs(pieces.stiffness_end / pieces.stiffness_start - 1.0).max())


def truncation(gears: Gears) -> float:
    """Error of the largest multiplier in the zone of order 1 by 3 harmonics of k(t) in place of k(t)."""
    pieces = gears.at_ratio(2.0, damping=0.0).closed_form()
    exact = np.abs(pieces.multipliers).max()
    return float(abs(_truncated(pieces, _HARMONICS) - exact))


def subharmonic(gears: Gears) -> float:
    """The largest multiplier in the zone of order 1, by the bound on its error nearer to 0."""
    spectrum = gears.at_ratio(2.0).multipliers
    value = complex(spectrum.multipliers[0])
    if abs(value.imag) > spectrum.error:
        return 0.0
    return float(value.real - np.sign(value.real) * spectrum.error)


def edge_shift(gears: Gears) -> float:
    """Largest shift of an edge of the zone of order 1 by friction, over the speed of the zone."""
    dry, rough = gears.zone(1, 0.0), gears.zone(1, MU)
    return max(abs(rough.low - dry.low), abs(rough.high - dry.high))


def widening(gears: Gears, order: int) -> float:
    """Growth of the width of a zone by friction, over its width."""
    return gears.zone(order, MU).width / gears.zone(order, 0.0).width - 1.0


def widening_1(gears: Gears) -> float:
    """`widening` of order 1."""
    return widening(gears, 1)


def widening_3(gears: Gears) -> float:
    """`widening` of order 3."""
    return widening(gears, 3)


def decay(gears: Gears) -> float:
    """Change of the decay over a mesh cycle, -log det M, by friction, over the decay without friction."""
    rough, dry = (gears.at_ratio(_AWAY, mu=mu).multipliers.multipliers for mu in (MU, 0.0))
    return float(np.log(np.abs(np.prod(rough))) / np.log(np.abs(np.prod(dry))) - 1.0)


def approach_and_recess(gears: Gears) -> float:
    """Stiffness just behind the pitch point over that just before it, in single contact."""
    model = gears.at_ratio(_AWAY)
    g = model.pair.geometry
    pitch = (g.L_XP - g.L_XA) / g.base_pitch % 1.0 * model.period
    before, behind = model.stiffness(pitch + 1e-6 * model.period * np.array([-1.0, 1.0]))
    return float(behind / before)


def reversal(gears: Gears, ratio: float) -> float:
    """Largest distance from the pitch point at which a loaded pair slides backwards, over the base pitch."""
    model = gears.at_ratio(ratio)
    motion = model.motion(2048)
    g = model.pair.geometry
    load = motion["normal_load"].to_numpy()
    distance = motion["position"].to_numpy() - g.L_XP
    sliding = motion["sliding_velocity"].to_numpy()
    loaded = (motion["contact"].to_numpy() > 0) & (load != 0.0)
    return farthest_reversal(distance, sliding, loaded) / g.base_pitch


def reversal_away(gears: Gears) -> float:
    """`reversal` away from resonances."""
    return reversal(gears, _AWAY)


def reversal_resonance(gears: Gears) -> float:
    """`reversal` at the resonance of the first mesh harmonic."""
    return reversal(gears, 1.0)


def peak_to_peak(gears: Gears) -> float:
    """Peak to peak of the motion with friction of the dynamic load over that of the mean load."""
    model = gears.at_ratio(_AWAY)
    time = model.period * np.arange(1024) / 1024
    dynamic = model.closed_form(damper_friction=False).motion(time).dte
    mean = model.closed_form(friction_load="mean").motion(time).dte
    return float(np.ptp(dynamic) / np.ptp(mean))


#: Name in statements.toml -> number of one pair.
NUMBERS: Mapping[str, Callable[[Gears], float]] = {
    one.__name__: one
    for one in (
        friction_alone, meissner, bessel, slope, truncation, subharmonic, edge_shift,
        widening_1, widening_3, decay, approach_and_recess, reversal_away, reversal_resonance, peak_to_peak,
    )
}  # fmt: skip


def _distance(some: FloatArray, others: FloatArray) -> float:
    """Largest distance of a value from the nearest of the others."""
    return float(np.abs(np.asarray(some)[:, None] - others).min(axis=1).max())


def _harmonic(square: float, damping: float, length: float) -> FloatArray:
    """State at the end of a segment with constant k per state at its start, (2, 2)."""
    frequency = np.sqrt(square - damping**2)
    cosine, sine = np.cos(frequency * length), np.sin(frequency * length) / frequency
    rows = [[cosine + damping * sine, sine], [-square * sine, cosine - damping * sine]]
    return np.exp(-damping * length) * np.array(rows)


def _bessel(a: float, b: float, length: float) -> FloatArray:
    """State at the end of a segment per state at its start, (2, 2), for y'' + (a + b t) y = 0.

    With w = a + b t and z = 2 w^(3/2)/(3 |b|) sqrt(w) J_(1/3)(z) and sqrt(w) J_(-1/3)(z) are solutions; their
    rates are sign(b) w J_(-2/3)(z) and -sign(b) w J_(2/3)(z).
    """

    def solutions(time: float) -> FloatArray:
        w = a + b * time
        z = 2.0 * w**1.5 / (3.0 * abs(b))
        values = [np.sqrt(w) * jv(order, z) for order in (1 / 3, -1 / 3)]
        rates = [np.sign(b) * w * jv(-2 / 3, z), -np.sign(b) * w * jv(2 / 3, z)]
        return np.array([values, rates])

    return np.asarray(solutions(length) @ np.linalg.inv(solutions(0.0)))


def _truncated(pieces: LinearSegments, harmonics: int) -> float:
    """Spectral radius with a Fourier series in place of k(t), by proven bounds."""
    T = pieces.period
    orders = np.arange(1, harmonics + 1)
    series = np.zeros(harmonics, dtype=complex)
    mean = 0.0
    for (low, high), start, end in zip(
        pairwise(pieces.edges), pieces.stiffness_start, pieces.stiffness_end, strict=True
    ):
        # Integral of (k_0 + k_1 s) exp(-i w t) over the segment, by parts.
        mean += 0.5 * (start + end) * (high - low) / T
        w = 2.0 * np.pi * orders / T
        rate = (end - start) / (high - low)
        at_end, at_start = (np.exp(-1j * w * t) for t in (high, low))
        series += 1j * (end * at_end - start * at_start) / w + rate * (at_end - at_start) / w**2
    series *= 2.0 / T
    k = FourierSeries(
        T, mean / pieces.mass, list(series.real / pieces.mass), list(-series.imag / pieces.mass)
    )
    spring = np.array([[0.0, 0.0], [-1.0, 0.0]])
    system = PeriodicSystem(PeriodicMatrix(np.array([[0.0, 1.0], [0.0, 0.0]]), (k, spring)), T)
    return floquet.monodromy(system, 1e-9).spectral_radius

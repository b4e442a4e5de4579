"""How far two histories are apart: pure functions on equally sampled arrays.

``candidate`` is the history that is judged, ``reference`` the one it is judged by; both have the same shape
and the same equidistant times. Nothing here knows gears or units.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lumped.errors import NumericalError, refuse
from lumped.typing import FloatArray

#: A history whose variation is below this share of its size is constant up to rounding.
_CONSTANT = 1e-13


@dataclass(frozen=True)
class SpragueGeers:
    """Magnitude and phase error of a history, and both combined; 0 is perfect.

    Attributes
    ----------
    magnitude : M, positive where the candidate is larger
    phase : P, 0 to 1; a pure shift of a sine by phi gives phi/pi
    comprehensive : C = sqrt(M^2 + P^2)
    """

    magnitude: float
    phase: float
    comprehensive: float


@dataclass(frozen=True, eq=False)
class MeshOrders:
    """Harmonics of a periodic history, v(t) = sum_n a_n cos(2 pi n t/T_m + phi_n).

    Attributes
    ----------
    order : (k,) multiples of the mesh frequency, from 0 (the mean)
    amplitude : (k,) a_n, in the unit of the history; order 0 is the mean with its sign
    phase : (k,) phi_n [rad], in (-pi, pi]; 0 for order 0
    """

    order: NDArray[np.int64]
    amplitude: FloatArray
    phase: FloatArray


def sprague_geers(candidate: ArrayLike, reference: ArrayLike) -> SpragueGeers:
    """Sprague and Geers' magnitude and phase error of a history.

    M = sqrt(I_cc/I_rr) - 1,  P = arccos(I_cr/sqrt(I_cc I_rr))/pi,  C = sqrt(M^2 + P^2),
    with I_xy = integral of x y over time, c the candidate and r the reference.

    Parameters
    ----------
    candidate, reference : whole cycles; take the mean off first where it would hide the oscillation

    Raises
    ------
    ParameterError : different shapes, or fewer than 2 samples
    NumericalError : a history is zero, or a value is not finite

    References
    ----------
    M. A. Sprague and T. L. Geers, "Spectral elements and field separation for an acoustic fluid subject to
    cavitation", J. Comput. Phys. 184 (2003) 149-162.
    M. A. Sprague and T. L. Geers, "A spectral-element method for modelling cavitation in transient
    fluid-structure interaction", Int. J. Numer. Meth. Engng 60 (2004) 2467-2499.
    """
    c, r = _histories(candidate, reference)
    # Normalised first, so that squares of small displacements do not underflow.
    size_c = _positive(float(np.linalg.norm(c)), "is zero everywhere", "candidate")
    size_r = _positive(float(np.linalg.norm(r)), "is zero everywhere")
    u, v = c / size_c, r / size_r
    magnitude = size_c / size_r - 1.0
    # The angle between unit vectors from their chord and sum: arccos would lose half the digits near 0.
    angle = 2.0 * float(np.arctan2(np.linalg.norm(u - v), np.linalg.norm(u + v)))
    phase = angle / np.pi
    return SpragueGeers(magnitude, phase, float(np.hypot(magnitude, phase)))


def mesh_orders(values: ArrayLike, samples_per_cycle: int, orders: int) -> MeshOrders:
    """Amplitude and phase of a history at multiples of the mesh frequency.

    Parameters
    ----------
    values : (cycles * samples_per_cycle,) whole mesh cycles, the first sample at the start of one
    samples_per_cycle : samples per mesh cycle
    orders : highest order wanted, below half of ``samples_per_cycle``

    Notes
    -----
    Over whole cycles the discrete Fourier transform has a bin on every order, so nothing leaks. What is not
    periodic with the mesh cycle goes into the bins between the orders and is not counted.

    Raises
    ------
    ParameterError : not whole cycles, or too many orders
    NumericalError : a value is not finite
    """
    v = np.asarray(values, dtype=float)
    if v.ndim != 1 or samples_per_cycle < 2 or v.size == 0 or v.size % samples_per_cycle:
        allowed = f"whole mesh cycles of {samples_per_cycle} samples"
        raise refuse("values", f"shape {v.shape}", allowed, "Cut the history to whole mesh cycles.")
    if not 1 <= orders < samples_per_cycle / 2:
        raise refuse("orders", orders, f"1 to {(samples_per_cycle - 1) // 2}", "Take more samples per cycle.")
    if not np.isfinite(v).all():
        raise NumericalError("A history to be analysed by orders is not finite; check the run it comes from.")
    cycles = v.size // samples_per_cycle
    spectrum = np.fft.rfft(v)[::cycles][: orders + 1] / v.size
    amplitude = np.concatenate([[spectrum[0].real], 2.0 * np.abs(spectrum[1:])])
    phase = np.concatenate([[0.0], np.angle(spectrum[1:])])
    return MeshOrders(np.arange(orders + 1), amplitude, phase)


def phase_difference(first: ArrayLike, second: ArrayLike) -> FloatArray:
    """Difference first - second of two angles [rad], wrapped to (-pi, pi]."""
    difference = np.asarray(first, dtype=float) - np.asarray(second, dtype=float)
    return np.asarray(np.pi - np.mod(np.pi - difference, 2.0 * np.pi), dtype=np.float64)


def is_constant(values: ArrayLike) -> bool:
    """Whether a history varies by no more than rounding: measures relative to its span then mean nothing."""
    v = np.asarray(values, dtype=float)
    return bool(np.ptp(v) <= _CONSTANT * max(float(np.abs(v).max()), np.finfo(float).tiny))


def _histories(candidate: ArrayLike, reference: ArrayLike) -> tuple[FloatArray, FloatArray]:
    a, b = np.asarray(candidate, dtype=float), np.asarray(reference, dtype=float)
    if a.shape != b.shape or a.size < 2:
        allowed = f"the shape of the reference, {b.shape}, with 2 samples or more"
        raise refuse("candidate", f"shape {a.shape}", allowed, "Sample both histories at the same times.")
    if not (np.isfinite(a).all() and np.isfinite(b).all()):
        raise NumericalError("A history to be compared is not finite; check the run it comes from.")
    return a.ravel(), b.ravel()


def _positive(scale: float, what: str, which: str = "reference") -> float:
    if scale <= 0.0:
        raise NumericalError(f"The {which} history {what}, so a relative difference has no meaning.")
    return scale

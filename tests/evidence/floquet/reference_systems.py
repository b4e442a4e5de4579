"""Periodic systems whose stability is known exactly or to first order, on which the engine is verified."""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import eigh
from scipy.optimize import brentq
from scipy.special import mathieu_a, mathieu_b

from floquet.engine.monodromy import monodromy
from floquet.engine.system import PeriodicSystem, second_order
from floquet.rank_one.batch import fast_multipliers
from floquet.rank_one.system import Gains, RankOneSystem
from lumped.typing import BoolArray, FloatArray


def meissner(delta: float, epsilon: float, period: float = 2.0 * np.pi) -> PeriodicSystem:
    """Return x'' + (delta + epsilon s) x = 0 with s = 1 in the first half of the period and -1 in the second.

    At the switches A is not a number, so that a propagator that evaluates A at a switch fails the check.
    """

    def A(t: FloatArray) -> FloatArray:
        k = np.where(t < 0.5 * period, delta + epsilon, delta - epsilon)
        k[(t == 0.0) | (t == 0.5 * period) | (t == period)] = np.nan
        return second_order(k[:, None, None], 0.0)

    return PeriodicSystem(A, period, (0.5 * period,), vectorized=True)


def meissner_trace(delta: float, epsilon: float, period: float = 2.0 * np.pi) -> float:
    """Trace of the monodromy matrix of `meissner`, 0 <= epsilon < delta.

    Two harmonic motions w1, w2 of half a period each: 2 cos cos - (w1/w2 + w2/w1) sin sin (Meissner 1918).
    """
    w1 = np.sqrt(delta + epsilon)
    w2 = np.sqrt(delta - epsilon)
    p1 = 0.5 * w1 * period
    p2 = 0.5 * w2 * period
    return float(2 * np.cos(p1) * np.cos(p2) - (w1 / w2 + w2 / w1) * np.sin(p1) * np.sin(p2))


def mathieu(a: float, q: float, c: float = 0.0) -> PeriodicSystem:
    """Return x'' + 2 c x' + (a - 2 q cos 2t) x = 0 with its basic period pi."""

    def A(t: FloatArray) -> FloatArray:
        return second_order((a - 2.0 * q * np.cos(2.0 * t))[:, None, None], 2.0 * c)

    return PeriodicSystem(A, np.pi, vectorized=True)


def mathieu_many(a: FloatArray, q: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Multipliers (k, 2) of many undamped Mathieu equations with a > 0, and bounds on the errors.

    With time in units of 1/sqrt(a) it is z'' + (1 - 2 (q/a) cos) z = 0 with the period pi sqrt(a): one fit.
    """
    multipliers = fast_multipliers(
        mathieu_system(), np.pi * np.sqrt(a), 1.0, (q / a)[:, None], tolerance=1e-13
    )
    return multipliers.multipliers, multipliers.errors


def mathieu_system(depth: float | None = None, damping: float = 0.0) -> RankOneSystem:
    """z'' + damping z' + (1 - 2 depth cos) z = 0; without a depth it is the factor of a varied gain."""
    pieces = 24
    degree = 8
    phases = np.linspace(0.0, 1.0, pieces + 1)
    u = np.polynomial.chebyshev.chebpts1(degree + 1)
    waves = np.zeros((pieces, 1, degree + 1))
    for k, (low, high) in enumerate(itertools.pairwise(phases)):
        values = -2.0 * np.cos(2.0 * np.pi * (0.5 * (low + high) + 0.5 * (high - low) * u))
        waves[k, 0] = np.polynomial.polynomial.polyfit(u, values, degree)
    one = np.zeros_like(waves)
    none = np.zeros((pieces, 1, 1))
    one[:, :, 0] = 1.0
    errors = np.tile([1e-12, 0.0], (pieces, 1))  # (2 pi/48)^9 2^-7/9! and rounding
    constant_gains = Gains(
        one + (0.0 if depth is None else depth * waves), damping * one, (depth or 0.0) * errors
    )
    varied = (Gains(waves, none, errors),) if depth is None else ()
    return RankOneSystem(
        np.zeros((1, 1)), np.zeros((1, 1)), np.ones(1), phases, constant_gains, np.pi, np.ones(1), varied
    )  # fmt: skip


def mathieu_unstable(a: FloatArray, q: float) -> tuple[BoolArray, FloatArray]:
    """Whether Mathieu equations are unstable up to b_9, a < a_0 or b_m < a < a_m (DLMF 28.17); the edges."""
    edges = [mathieu_a(0, q)] + [f(m, q) for m in range(1, 10) for f in (mathieu_b, mathieu_a)]
    return np.searchsorted(edges, a) % 2 == 0, np.array(edges)


@dataclass(frozen=True, eq=False)
class HsuSystem:
    """z_i'' + 2 c_i z_i' + omega_i^2 z_i + epsilon cos(Omega t) sum_j d_ij z_j = 0.

    The system of C. S. Hsu (J. Appl. Mech. 30 (1963) 367-372 and 32 (1965) 373-377). With d symmetric sums
    of frequencies are unstable, with d skew (circulatory) differences are."""

    omega: FloatArray  # (m,) natural frequencies
    coupling: FloatArray  # (m, m) d
    damping: FloatArray  # (m,) c; zeros for the undamped system

    def at(self, excitation: float, epsilon: float) -> PeriodicSystem:
        """Return the system at excitation frequency Omega and strength epsilon."""
        K = np.diag(self.omega**2)
        C = np.diag(2.0 * self.damping)

        def A(t: FloatArray) -> FloatArray:
            return second_order(K + epsilon * np.cos(excitation * t)[:, None, None] * self.coupling, C)

        return PeriodicSystem(A, 2.0 * np.pi / excitation, vectorized=True)

    def boundaries(self, i: int, j: int, sign: int, epsilon: float) -> tuple[float, float] | None:
        """First-order ends of the tongue at omega_j + sign omega_i (modes from 0); None: there is no tongue.

        Averaging gives amplitudes of mode j and of the (conjugate, for a sum) motion of mode i with
        (s + c_j + i sigma/2)(s + c_i - i sigma/2) = sign epsilon^2 d_ij d_ji/(16 omega_i omega_j), sigma the
        detuning Omega - omega_j - sign omega_i. On the boundary Re s = 0:

            sigma = +- (c_i + c_j) sqrt(G/(c_i c_j) - 1),  G = sign epsilon^2 d_ij d_ji/(16 omega_i omega_j),

        and +- 2 sqrt(G) without damping. The error is of order epsilon^2 (with c of order epsilon).
        """
        d = self.coupling
        G = sign * epsilon**2 * d[i, j] * d[j, i] / (16.0 * self.omega[i] * self.omega[j])
        ci = self.damping[i]
        cj = self.damping[j]
        if ci * cj >= G:
            return None
        half = 2.0 * np.sqrt(G) if ci == cj == 0.0 else (ci + cj) * np.sqrt(G / (ci * cj) - 1.0)
        centre = self.omega[j] + sign * self.omega[i]
        return float(centre - half), float(centre + half)


@dataclass(frozen=True, eq=False)
class GearChain:
    """Rotors in line, joined by meshes whose stiffness jumps with the number of tooth pairs in contact.

    M x'' + (K_0 + sum_m k_m(t) v_m v_m^T) x = 0 with rectangular waves k_m: the chains of Lin and Parker
    (Mesh stiffness variation instabilities in two-stage gear systems, J. Vib. Acoust. 124 (2002) 68-76), all
    meshes of one mesh frequency Omega as on an idler gear."""

    mass: FloatArray  # (n,) M, diagonal
    ground: FloatArray  # (n, n) K_0
    meshes: FloatArray  # (p, n) v_m
    stiffness: FloatArray  # (p,) mean stiffness of each mesh
    contact_ratio: FloatArray  # (p,) sigma_m in 1..2: two pairs for the part sigma_m - 1 of the cycle
    phase: FloatArray  # (p,) parts of a cycle after which double contact of a mesh begins

    def modes(self) -> tuple[FloatArray, FloatArray]:
        """Natural frequencies (n,) and mass-normalised modes (n, n) of the mean system."""
        K = self.ground + np.einsum("p,pi,pj->ij", self.stiffness, self.meshes, self.meshes)
        squares, shapes = eigh(K, np.diag(self.mass))
        return np.sqrt(squares), shapes

    def at(self, excitation: float, epsilon: float) -> PeriodicSystem:
        """Return the chain at mesh frequency Omega; mesh stiffness jumps by epsilon times its mean."""
        period = 2.0 * np.pi / excitation
        starts = self.phase % 1.0
        ends = (self.phase + self.contact_ratio - 1.0) % 1.0

        def A(t: FloatArray) -> FloatArray:
            since = (t[:, None] / period - starts) % 1.0
            double = since < self.contact_ratio - 1.0
            # Fluctuation of mean zero and peak to peak epsilon.
            k = self.stiffness * (1.0 + epsilon * (double - (self.contact_ratio - 1.0)))
            K = self.ground + np.einsum("tp,pi,pj->tij", k, self.meshes, self.meshes)
            return second_order(K / self.mass[:, None], 0.0)

        switches = np.concatenate([starts, ends])
        return PeriodicSystem(A, period, tuple(switches * period), vectorized=True)

    def coupling(self, i: int, j: int, harmonic: int) -> float:
        """|Lambda|: amplitude, per unit epsilon, with which a harmonic of the meshes couples modes i and j.

        The l-th harmonic of a rectangular wave has amplitude 2 |sin(l pi (sigma - 1))|/(l pi); meshes add up
        with their phases and the modes' deflections in them.
        """
        _, shapes = self.modes()
        width = self.contact_ratio - 1.0
        amplitude = 2.0 * np.sin(harmonic * np.pi * width) / (harmonic * np.pi) * self.stiffness
        angle = -2.0j * np.pi * harmonic * (self.phase + 0.5 * width)
        deflection = self.meshes @ shapes
        return float(abs((amplitude * np.exp(angle) * deflection[:, i] * deflection[:, j]).sum()))

    def boundaries(self, i: int, j: int, harmonic: int, epsilon: float) -> tuple[float, float]:
        """First-order ends of the tongue where harmonic * Omega = omega_i + omega_j (modes from 0).

        Omega = (omega_i + omega_j +- epsilon |Lambda|/(2 sqrt(omega_i omega_j)))/harmonic, as for `HsuSystem`
        with the harmonic as excitation.
        """
        omega, _ = self.modes()
        centre = (omega[i] + omega[j]) / harmonic
        half = epsilon * self.coupling(i, j, harmonic) / (2.0 * np.sqrt(omega[i] * omega[j]) * harmonic)
        return float(centre - half), float(centre + half)


def tongue_ends(
    system: HsuSystem | GearChain, predicted: Sequence[float], epsilon: float, *, rtol: float = 1e-11
) -> tuple[float, float]:
    """Ends of the tongue around a predicted one, by root finding on the computed spectral radius."""
    damped = isinstance(system, HsuSystem) and bool((system.damping > 0.0).any())
    limit = 1.0 if damped else 1.0 + np.sqrt(rtol)
    middle = 0.5 * (predicted[0] + predicted[1])
    width = predicted[1] - predicted[0]

    def excess(excitation: float) -> float:
        return monodromy(system.at(excitation, epsilon), rtol).spectral_radius - limit

    lower, upper = (brentq(excess, middle, middle + end * width, xtol=1e-9 * middle) for end in (-1.0, 1.0))
    return float(lower), float(upper)

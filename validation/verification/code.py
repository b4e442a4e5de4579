"""The code against closed forms, laws of mechanics and theoretical orders, computed when asked.

Sources: the closed forms are derived where they are used; Oberkampf and Roy, Verification and
Validation in Scientific Computing, 2010, for the method.
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import expm
from scipy.special import mathieu_a, mathieu_b

import multibody
from floquet import PeriodicSystem, gear_pair_multipliers, gear_pair_system, monodromy
from floquet.engine.propagation import propagate_fixed
from floquet.engine.propagators import propagator
from lumped import GearPair, steady_state
from lumped.friction import benedict_kelley, xu_kahraman
from lumped.lubrication.film import effective_modulus, film_parameter, film_thickness, hertz_half_width
from lumped.typing import FloatArray
from validation.verification.checks import Check, OrderCheck

_CYCLES = 3
#: Method -> steps over the period at which its error is above rounding and already asymptotic.
_METHODS = {"rk4": 64, "gauss4": 16, "gauss6": 8, "gauss8": 8, "magnus4": 16, "magnus6": 8, "dop853": 16}


def code_checks(pair: GearPair) -> tuple[Check, ...]:
    """Errors against closed forms and laws of mechanics; those on a gear pair use this one.

    Raises
    ------
    NumericalError : a model fails on this pair
    """
    return (
        _law_ii(),
        _law_iii(),
        _film(),
        _meissner(),
        _mathieu(),
        _constant(),
        _block_form(pair),
        *_lumped_identities(pair),
        *(_energy(pair, fidelity) for fidelity in ("linear", "exact")),
    )


def _stated(key: str, subject: str, values: list[tuple[float, float]]) -> Check:
    """Check of a published formula against values worked out by hand, to the digits stated."""
    return Check(
        key=key,
        subject=subject,
        exact="values worked out twice from the published formula, apart from this code",
        value=max(abs(found / wanted - 1.0) for found, wanted in values),
        limit=2e-6,
        reason="the values are stated to six or seven digits",
    )


def _law_ii() -> Check:
    found = float(benedict_kelley(100, 10, 2, 10, 0.4))
    return _stated("law_ii", "law II, Benedict and Kelley", [(found, 0.06235267)])


def _law_iii() -> Check:
    found = float(xu_kahraman(1.0, 0.1, 10, 10, 0.3, 0.008))
    return _stated("law_iii", "law III, Xu and Kahraman", [(found, 0.01039515)])


def _film() -> Check:
    modulus = effective_modulus(206e3, 0.3, 206e3, 0.3)
    thickness = film_thickness(100, 8, 10, 10, modulus)
    width = hertz_half_width(100, 8, modulus)
    parameter = film_parameter(thickness, width, 0.5, 0.8)
    wanted = (0.312115, 0.0948642, 1.281808)
    found = [float(value) for value in (thickness, width, parameter)]
    return _stated(
        "film",
        "film thickness, Hertzian width, film parameter",
        [(a, b) for a, b in zip(found, wanted, strict=True)],
    )


def _oscillator(stiffness: FloatArray) -> FloatArray:
    """System matrices (k, 2, 2) of x'' + stiffness x = 0."""
    a = np.zeros((stiffness.size, 2, 2))
    a[:, 0, 1], a[:, 1, 0] = 1.0, -stiffness
    return a


def _meissner() -> Check:
    """Trace of M = 2 cos cos - (w1/w2 + w2/w1) sin sin of two harmonic motions, half a period each."""
    worst, period = 0.0, 2 * np.pi
    for delta, epsilon in ((1.3, 0.4), (4.0, 3.0), (2.2, 0.05)):
        high, low = delta + epsilon, delta - epsilon
        system = PeriodicSystem(
            lambda t, a=high, b=low: _oscillator(np.asarray(np.where(t < np.pi, a, b), dtype=float)),
            period,
            (period / 2,),
            vectorized=True,
        )
        w1, w2 = np.sqrt(high), np.sqrt(low)
        p1, p2 = w1 * period / 2, w2 * period / 2
        exact = 2 * np.cos(p1) * np.cos(p2) - (w1 / w2 + w2 / w1) * np.sin(p1) * np.sin(p2)
        worst = max(worst, abs(float(np.trace(monodromy(system, rtol=1e-11).matrix) - exact)))
    return Check(
        key="meissner",
        subject="monodromy matrix across jumps of stiffness",
        exact="trace of Meissner's equation in closed form (1918), three cases; absolute",
        value=worst,
        limit=1e-9,
        reason="asked for to 1e-11 of a matrix smaller than 10, with a factor ten of room",
    )


def _mathieu_system(a: float, q: float) -> PeriodicSystem:
    """Mathieu's equation x'' + (a - 2 q cos 2t) x = 0 over its period pi."""
    return PeriodicSystem(lambda t: _oscillator(a - 2 * q * np.cos(2 * t)), np.pi, vectorized=True)


def _mathieu() -> Check:
    worst = 0.0
    for order in (1, 2, 3):
        for boundary in (mathieu_a, mathieu_b):
            system = _mathieu_system(float(boundary(order, 1.0)), 1.0)
            trace = float(np.trace(monodromy(system, rtol=1e-11).matrix))
            worst = max(worst, abs(trace - 2 * (-1) ** order))
    return Check(
        key="mathieu",
        subject="stability boundaries of a smooth system",
        exact="trace ±2 on the characteristic curves a_m, b_m of Mathieu's equation, m = 1 to 3, q = 1 "
        "(DLMF 28.2); absolute",
        value=worst,
        limit=1e-9,
        reason="characteristic values are good to 1e-13, times the slope of the trace",
    )


def _constant() -> Check:
    matrix = np.random.default_rng(7).normal(size=(5, 5)) - 0.5 * np.eye(5)
    found = monodromy(PeriodicSystem(lambda t: matrix, 2.0), rtol=1e-11).matrix
    exact = expm(2.0 * matrix)
    return Check(
        key="constant",
        subject="monodromy matrix of constant coefficients",
        exact="the matrix exponential",
        value=float(np.linalg.norm(found - exact) / np.linalg.norm(exact)),
        limit=1e-10,
        reason="asked for to 1e-11 in a balanced norm",
    )


def _block_form(pair: GearPair) -> Check:
    """The multipliers of all ten states against those of the 6-state block and the closed form of y."""
    block = gear_pair_multipliers(pair, rtol=1e-9)
    whole = monodromy(gear_pair_system(pair, "relative"), rtol=1e-9)
    gap = np.abs(whole.multipliers[:, None] - block.multipliers[None, :]).min(axis=1)
    return Check(
        key="block_form",
        subject="multipliers of this pair by blocks, those of y in closed form",
        exact="multipliers of the whole ten-state system; absolute",
        value=float(gap.max()),
        limit=1e-6,
        reason="close multipliers spread the error of the matrix, 1e-9, by its root at worst",
    )


def _lumped_identities(pair: GearPair) -> tuple[Check, Check, Check]:
    """What a periodic motion must fulfil whatever the parameters are."""
    free = pair.with_({"friction.law": "none"})
    g = pair.geometry
    motion = steady_state(free, samples_per_cycle=1024)
    static = float(motion.attrs["pinion_torque"]) / g.base_radius_pinion
    held = -float(motion["x_p"].mean()) * pair.bearings.pinion.loa_stiffness
    mean_load = Check(
        key="mean_load",
        subject="periodic motion of this pair without friction",
        exact="the pinion bearing carries T_p/r_bp on average (mean of equations 1 and 6)",
        value=abs(held / static - 1.0),
        limit=1e-6,
        reason="mean of 1024 samples of a motion whose second derivative jumps",
    )
    efficiency = Check(
        key="no_loss",
        subject="mesh efficiency of this pair without friction",
        exact="1: nothing takes power from a frictionless mesh at constant mean speed",
        value=abs(float(motion.attrs["mesh_efficiency"]) - 1.0),
        limit=1e-9,
        reason="rounding of the solution for the brake torque",
    )
    rough = steady_state(pair, samples_per_cycle=4096)
    drive = float(rough.attrs["pinion_torque"]) * g.omega_pinion
    nominal = -float(rough["friction_power_nominal"].sum("pair").mean())
    loss = Check(
        key="loss",
        subject="loss of this pair from the balanced brake torque",
        exact="mean friction power at nominal sliding; relative to the driving power",
        value=abs((1.0 - float(rough.attrs["mesh_efficiency"])) * drive - nominal) / drive,
        limit=1e-4,
        reason="mean of 4096 samples of a function that jumps, of which losses are a few percent",
    )
    return mean_load, efficiency, loss


def _energy(pair: GearPair, fidelity: str) -> Check:
    balance = multibody.power_balance(pair, _CYCLES, fidelity=fidelity)  # type: ignore[arg-type]
    return Check(
        key=f"energy_{fidelity}",
        subject=f"multibody model, {fidelity}: {_CYCLES} mesh cycles from rest",
        exact="first law: driving work = braking work + stored + dissipated; over the driving work",
        value=abs(balance.residual) / abs(balance.driving),
        limit=1e-7,
        reason="integrated to 1e-8 per step",
    )


def order_checks() -> tuple[OrderCheck, ...]:
    """Observed orders of the propagators on Mathieu's equation, a = 3, q = 2, at a fixed number of steps."""
    system = _mathieu_system(3.0, 2.0)
    exact = propagate_fixed(system, propagator("gauss"), 64)
    size = float(np.linalg.norm(exact))
    rows = []
    for name, steps in _METHODS.items():
        method = propagator(name)
        coarse, fine = (
            float(np.linalg.norm(propagate_fixed(system, method, n) - exact)) / size
            for n in (steps, 2 * steps)
        )
        rows.append(OrderCheck(name, method.order, float(np.log2(coarse / fine)), steps, fine))
    return tuple(rows)

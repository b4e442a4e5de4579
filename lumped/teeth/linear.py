"""The linear form of teeth that differ: maps of mesh cycles about the own static state, and its motion.

Sources: docs/theory/teeth.md, "The linear form", "Stability".
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from lumped.errors import NumericalError
from lumped.gauss_legendre import gauss_tableau
from lumped.model.kernels import chained, states_along
from lumped.model.periodic_system import LTVSystem, Supports
from lumped.model.propagation import STAGES, fastest_frequency, maps_of_steps, padded
from lumped.model.steady import balanced_start, periodic_solution
from lumped.schema.pair import GearPair
from lumped.teeth import kernels
from lumped.teeth.contact import Laws, tables
from lumped.teeth.motion import OwnMotion, moments, ripples, static_mesh, swinging, without_drift
from lumped.typing import FloatArray

#: Largest angle of the fastest vibration in a step [rad]: order 8 errs by some 1e-5 of that vibration, less
#: than the touches of pairs inside steps do.
_STEP_ANGLE = 2.4
_LEAST_STEPS = 48
#: Mesh cycles whose steps are in memory together; all are up to so many steps, 2.5 kB each.
_BLOCK, _MOST_KEPT = 64, 60_000


def linear_steps(system: LTVSystem) -> int:
    """Steps in a mesh cycle that the fastest vibration asks for."""
    return max(_LEAST_STEPS, math.ceil(fastest_frequency(system) * system.period / _STEP_ANGLE))


class LinearForm:
    """Gauss steps through every mesh cycle of the period, in blocks of cycles.

    ``system`` gives the coordinates, of any form; ``steps`` is the least number in a cycle, ``most`` ends
    the form after so many cycles.
    """

    def __init__(
        self, pair: GearPair, system: LTVSystem, samples: int, steps: int, most: int | None = None
    ) -> None:
        self.pair, self.system = pair, system
        self.laws, self.fixed = Laws(pair), pair.mesh.contact != "loaded"
        self.own = tables(self.laws, 1.0 / steps, samples, gauss_tableau(STAGES)[2])
        if system.form == "full":
            self.own = swinging(self.own, system)
        self.lengths = np.diff(self.own.edges) * system.period
        self.kept: dict[int, tuple[FloatArray, FloatArray]] = {}
        torques = np.stack([system.torque_pinion, system.torque_gear], axis=1)
        self.extra = padded(system, torques)
        count = self.own.period if most is None else min(most, self.own.period)
        self.cycles = [(first, min(_BLOCK, count - first)) for first in range(0, count, _BLOCK)]

    def mesh(self) -> Iterator[FloatArray]:
        """``sums`` of ``kernels.static_cycles`` at the stages of each block, (cycles, steps, s, 17)."""
        for first, count in self.cycles:
            yield static_mesh(self.own, first, count, self.fixed)[2]

    def step_maps(self, first: int, sums: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Maps of the steps of a block, and to delta and its rate inside, as ``model.propagation.Steps``."""
        system = self.system
        by_load = system.per_load[0] + sums[..., 9:11] @ moments(system)
        gains = [
            sums[..., n : n + 1] * by_load + sums[..., n + 1 : n + 3] @ system.per_load[1:] for n in (0, 3, 6)
        ]
        for gain, n in zip(gains, (14, 15, 16), strict=True):
            gain += sums[..., n : n + 1] * system.per_apart
        edges, m = self.own.edges, len(system.coordinates)
        tau = edges[:-1, None] + np.diff(edges)[:, None] * self.own.nodes
        at = first + np.arange(sums.shape[0])[:, None, None] + tau
        for which, angle, phase, amplitude, turn in ripples(self.pair):
            torque = (system.torque_gear if which else system.torque_pinion)[m:]
            gains[2] += amplitude * np.cos(angle * (at % turn) + phase)[..., None] * torque
        shape = (-1, self.own.nodes.size, m)
        lengths = np.tile(self.lengths, sums.shape[0])
        return maps_of_steps(system, lengths, self.extra, [gain.reshape(shape) for gain in gains])

    def cycle_maps(self, mesh: list[FloatArray] | None = None) -> FloatArray:
        """Affine map of each mesh cycle, (cycles, n, n + columns); ``mesh`` where it is known already."""
        found = []
        keeps = mesh is not None and self.own.period * self.lengths.size <= _MOST_KEPT
        for (first, count), sums in zip(self.cycles, mesh or self.mesh(), strict=True):
            steps = self.step_maps(first, sums)
            if keeps:
                self.kept[first] = steps
            found.append(chained(steps[0], np.repeat(np.arange(count), self.lengths.size)))
        return np.concatenate(found)


def linear_motion(
    pair: GearPair, samples: int, supports: Supports = "springs", steps: int | None = None
) -> OwnMotion:
    """Periodic motion of the linear form over the period of teeth that differ, by the maps of its cycles.

    Parameters
    ----------
    pair : a validated gear pair
    samples : outputs a mesh cycle
    supports : as of ``periodic_system``
    steps : least number of steps in a mesh cycle; by default by the fastest vibration
    """
    system = LTVSystem.of(pair.healthy, "full", supports=supports)
    twin = periodic_solution(system, np.zeros(1), estimate_error=False)
    steps = linear_steps(system) if steps is None else steps
    coarse = LinearForm(pair, system, 1, -(-steps // 2), _BLOCK)
    form = LinearForm(pair, system, samples, steps)
    mesh = list(form.mesh())
    maps = form.cycle_maps(mesh)
    whole, n = chained(maps, np.zeros(maps.shape[0], dtype=np.int64))[0], maps.shape[1]
    if not np.isfinite(whole).all():
        raise NumericalError("The motion grows beyond all numbers: take smaller deviations or more damping.")
    start, weights = balanced_start(system, whole[:, :n], whole[:, n : n + 3])
    # Rounding of the closing equations fades in a period, but that of the common rotation, which grows.
    support, m, dte = system.supports, len(system.coordinates), system.deflection
    moved, scale = (states_along(maps, start, weights)[-1] - start).reshape(2, m), support.common_weights
    moved -= np.outer(moved @ scale, support.common) / (scale @ support.common)
    start = start + moved.ravel()
    cycles = states_along(maps, start, weights)
    other = states_along(coarse.cycle_maps(), start, weights)
    error = np.abs((cycles[: len(other)] - other)[:, :m] @ dte).max() / np.abs(cycles[:, :m] @ dte).max()
    states, powers = _inside(form, mesh, cycles, weights)
    states = without_drift(system, np.arange(states.shape[0]) / samples * system.period, states, 0.0)
    outer = swinging(tables(form.laws, 1.0, samples), system)
    each = static_mesh(outer, 0, outer.period, form.fixed)[1][..., np.flatnonzero(outer.outputs)]
    _, rise, damper, constant = each.reshape(4, outer.ahead.size, -1)
    load = rise * (states[:, :m] @ dte) + damper * (states[:, m:] @ dte) + constant
    g, torque, brake = pair.geometry, system.pinion_torque + float(weights[1]), float(weights[2])
    # The first law gives what slides.
    lost = powers["tooth_dampers"] + powers["supports"] - powers["rolling"]
    powers["sliding"] = torque * g.omega_pinion - brake * g.omega_gear - lost
    largest = np.abs(cycles[:, :m] @ support.relative.T).max()
    return OwnMotion(
        pair=pair,
        system=system,
        tables=outer,
        form=kernels.FIXED if form.fixed else kernels.LINEAR,
        time=np.arange(states.shape[0]) / samples * system.period,
        states=states,
        load=load,
        pinion_torque=torque,
        brake_torque=brake,
        powers=powers,
        closure=float(np.abs(support.relative @ (cycles[-1] - cycles[0])[:m]).max() / largest),
        error=float(error),
        spectral_radius=twin.spectral_radius,
    )


def _inside(
    form: LinearForm, mesh: list[FloatArray], cycles: FloatArray, weights: FloatArray
) -> tuple[FloatArray, dict[str, float]]:
    """States at the outputs, and mean powers that the motion inside the steps tells [W]."""
    system, own = form.system, form.own
    m, gears, b = len(system.coordinates), system.gears, gauss_tableau(STAGES)[1]
    rates = np.vstack([gears[:2], gears[5] - gears[4]])
    outputs, work = [], np.zeros(3)
    g = form.pair.geometry
    for (first, count), sums in zip(form.cycles, mesh, strict=True):
        maps, inside = form.kept.get(first) or form.step_maps(first, sums)
        states = states_along(maps, cycles[first], weights)
        outputs.append(states[:-1][np.tile(own.outputs == 1, count)])
        columns = m * 2 + weights.size
        known = np.hstack([states[:-1], np.broadcast_to(weights, (states.shape[0] - 1, weights.size))])
        delta, closing = np.einsum("kdsc,kc->dks", inside[..., :columns], known)
        lengths = np.tile(form.lengths, count)
        n = np.moveaxis(sums.reshape(-1, b.size, sums.shape[-1]), -1, 0)
        load, taken = n[0] * delta + n[3] * closing + n[6], (n[11] * closing + n[12]) * closing + n[13]
        turning = states[:, m:] @ rates.T
        along = turning[:-1, None] + own.nodes[:, None] * np.diff(turning, axis=0)[:, None]
        late = n[9] * (g.omega_pinion + along[..., 0]) + n[10] * (g.omega_gear + along[..., 1])
        corners = (n[14] * delta + n[15] * closing + n[16]) * along[..., 2]
        outside = np.sum(list(system.supports.powers(states[:, m:]).values()), axis=0)
        work[0] += lengths @ (taken @ b)
        work[1] += lengths @ ((load * (closing - late) - corners) @ b)
        work[2] += 0.5 * (lengths @ (outside[1:] + outside[:-1]))
    dampers, moved, supports = (float(value) for value in work / (own.period * system.period))
    powers = {"tooth_dampers": dampers, "supports": supports, "rolling": dampers - moved}
    return np.concatenate(outputs), powers

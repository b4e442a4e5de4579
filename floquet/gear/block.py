"""The feedback block of a gear pair as a rank-one system for the compiled kernel.

Sources: docs/theory/floquet.md, "Structure".
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt
from scipy.interpolate import PPoly

from floquet.gear.axes import GearVariation
from floquet.gear.multipliers import mean_mesh_stiffness
from floquet.rank_one.piecewise import fit_pieces
from floquet.rank_one.system import Balance, Gains, RankOneSystem
from lumped.arguments import real_number
from lumped.model.mesh_cycle import MeshCycle
from lumped.model.periodic_system import LTVSystem, periodic_system
from lumped.path_function import PathFunction
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray


def gear_block(
    source: GearPair | GearVariation,
    rtol: float = 1e-11,
    *,
    friction_apart: bool = False,
    friction_level: float | None = None,
) -> RankOneSystem:
    """Return (q, x_p, x_g) of a gear pair: z'' + D z' + L z + w (v . z) + wd (v . z') = f.

    v = (1, 1, -1), v . z is the dynamic transmission error; w and wd collect what each pair's normal load and
    friction do to each coordinate, f the torques and what unloaded tooth errors do. The metric is (m_e, m_p,
    m_g), for which the frictionless mesh is symmetric.

    The torque that is not given, as a rule that of the brake, follows from a mean (`Balance`): with R = J_p
    theta_p/r_bp + J_g theta_g/r_bg, the rigid rotation, equations (1) and (2) give
    R'' = T_p/r_bp - T_g/r_bg - sum F_i (X_pi/r_bp - X_gi/r_bg), whose mean over a cycle at constant mean
    speed is zero.

    Parameters
    ----------
    source : a gear pair, or a variation from a chart
    rtol : error of the fitted polynomials relative to the largest gain; it becomes part of the error bounds
    friction_apart : whether what is proportional to mu becomes the ``varied`` part of the system, so that a
        factor on mu costs nothing
    friction_level : with friction apart, a constant |mu| that changes sign at the pitch point; mu less this,
        and this, become two ``varied`` parts, so that mu may also rise and fall as a whole
    """
    rtol = real_number("rtol", rtol, 1e-14, 0.1)
    if friction_level is not None:
        friction_level = real_number("friction_level", friction_level, 0.0, 10.0)
    variation = GearVariation(source) if isinstance(source, GearPair) else source
    system = periodic_system(variation.pair, "feedback", cycle=variation.cycle())
    per_load = -(system.structure.normal / system.structure.mass) @ system.reduction.T
    metric = 1.0 / np.abs(per_load)
    levels = ([0.0] if friction_level is None else [0.0, friction_level]) if friction_apart else []
    sampler = _Sampler(system, variation.stiffness_variation, levels)
    # The fourth row, the rigid rotation over m_e, is weighed like q.
    phases, fitted, errors = fit_pieces(
        sampler, system.cycle.edges / system.period, np.append(metric, metric[0]), rtol=rtol
    )
    blocks, rigid = [], []
    for p in range(sampler.parts):
        four, misfit = _four(fitted, errors, p, sampler)
        w, wd, f, fr = four
        blocks.append(Gains(w[:, :3], wd[:, :3], f[:, :3], fr[:, :3], misfit))
        rigid.append(Gains(w[:, 3:], wd[:, 3:], f[:, 3:], fr[:, 3:], misfit))
    torques, balance = _torques(variation.pair, system, metric[0], tuple(rigid))
    f = blocks[0].f.copy()
    f[:, :, 0] += torques
    blocks[0] = replace(blocks[0], f=f)
    return RankOneSystem(
        stiffness=-np.diag(system.constant[3:, :3]).copy(),
        damping=-np.diag(system.constant[3:, 3:]).copy(),
        v=system.deflection,
        phases=phases,
        gains=blocks[0],
        period=system.period,
        metric=metric,
        varied=tuple(blocks[1:]),
        balance=balance,
    )


def _four(
    fitted: list[FloatArray], errors: FloatArray, part: int, sampler: _Sampler
) -> tuple[list[FloatArray], FloatArray]:
    """w, wd, f and fr of one part out of the list of fitted gains, and their misfits (P, 4)."""
    pieces = errors.shape[0]
    zero, misfit = np.zeros((pieces, 4, 1)), np.zeros((pieces, 4))
    first = 2 * part
    four = [fitted[first], fitted[first + 1], zero, zero]
    misfit[:, :2] = errors[:, first : first + 2]
    if sampler.has_error:
        first += 2 * sampler.parts
        four[2:] = fitted[first], fitted[first + 1]
        misfit[:, 2:] = errors[:, first : first + 2]
    return four, misfit


def _torques(
    pair: GearPair, system: LTVSystem, mass: float, gains: tuple[Gains, ...]
) -> tuple[FloatArray, Balance]:
    """Forcing (3,) by the torques that are given, and the balance that the other one has to meet."""
    g, T_p = system.cycle.geometry, system.pinion_torque
    per_pinion, per_gear = 1.0 / (g.base_radius_pinion * mass), -1.0 / (g.base_radius_gear * mass)
    pinion, gear = system.torque_pinion[3:], system.torque_gear[3:]
    brake = pair.operating.brake_torque
    if isinstance(brake, str):
        return pinion * T_p, Balance(gear, gains, T_p * per_pinion, per_gear)
    known = T_p * per_pinion + brake * per_gear
    return pinion * T_p + gear * brake, Balance(pinion, gains, known, per_pinion)


class _Sampler:
    """What the mesh does to (q, x_p, x_g) and to the rigid rotation R/m_e, as `fit_pieces` asks for it.

    Gains in this order: feedback of deflection and of its rate by normal loads (with their friction, unless
    it is apart), the same by each part of friction, forcing by the unloaded error and its rate likewise. The
    parts of friction are mu less the sum of the ``levels``, and each level but the first, which is zero.
    """

    def __init__(self, system: LTVSystem, factor: float, levels: Sequence[float]) -> None:
        s, self.cycle = system.structure, system.cycle
        g = self.cycle.geometry
        rows = np.zeros((4, 6))
        rows[:3] = system.reduction
        effective = 1.0 / abs(float(rows[0] @ (s.normal / s.mass)))
        rows[3, :2] = s.mass[:2] / np.array([g.base_radius_pinion, g.base_radius_gear]) / effective
        self.normal = rows @ (s.normal / s.mass)
        self.arm = np.stack([rows @ (s.friction_arm[:, i] / s.mass) for i in (0, 1)])
        self.levels = levels
        self.parts = 1 + len(levels)
        self.factor = factor
        self.mean = mean_mesh_stiffness(system)
        e = self.cycle.elements
        self.has_error = bool(np.any(e.error.coefficients))
        self.k, self.c, self.mu, self.e = map(_poly, (e.stiffness, e.damping, e.friction, e.error))
        self.rate = self.e.derivative()
        self.low, self.high = _ends(self.cycle)

    def __call__(self, phases: FloatArray, segment: npt.NDArray[np.intp]) -> FloatArray:
        cycle = self.cycle
        g = cycle.geometry
        # Just inside the segment, so that pieces end where the segment does.
        shift = np.clip(phases * g.base_pitch, self.low[segment, None], self.high[segment, None])
        middle = 0.5 * (self.low + self.high)[segment]
        groups = np.zeros((self.parts * (4 if self.has_error else 2), *phases.shape, 4))
        ks = np.zeros((cycle.offsets.size, *phases.shape))
        xis = cycle.offsets[:, None, None] + shift
        touching = cycle.offsets[:, None] + middle <= g.L_XD
        for i, xi in enumerate(xis):
            ks[i] = np.where(touching[i][:, None], self.k(xi), 0.0)
        total = ks.sum(axis=0)
        f = (self.mean + self.factor * (total - self.mean)) / total if self.factor != 1.0 else 1.0
        for k, xi, touch in zip(ks, xis, touching, strict=True):
            if not touch.any():
                continue
            c = np.where(touch[:, None], self.c(xi), 0.0) * np.sqrt(f)
            k = k * f
            mu, arm = self.mu(xi)[..., None], self.arm[0] + xi[..., None] * self.arm[1]
            rows = [np.broadcast_to(self.normal, (*xi.shape, 4))]
            if self.levels:
                sign = np.sign(xi - g.L_XP)[..., None]
                rows += [(mu - sum(self.levels) * sign) * arm, *(s * sign * arm for s in self.levels[1:])]
            else:
                rows[0] = rows[0] + mu * arm
            loads = [k, c]
            if self.has_error:
                loads += [k * self.e(xi), c * self.rate(xi) * g.base_pitch]
            for j, load in enumerate(loads):
                for p, row in enumerate(rows):
                    index = 2 * p + j if j < 2 else 2 * len(rows) + 2 * p + j - 2
                    groups[index] -= load[..., None] * row
        return groups


def _poly(function: PathFunction) -> PPoly:
    return PPoly.construct_fast(function.coefficients, function.breaks)


def _ends(cycle: MeshCycle) -> tuple[FloatArray, FloatArray]:
    """Smallest and largest advance [m] inside each smooth segment."""
    edges = cycle.edges / cycle.period * cycle.geometry.base_pitch
    inside = 1e-12 * cycle.geometry.base_pitch
    return edges[:-1] + inside, edges[1:] - inside

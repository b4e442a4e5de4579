"""The feedback block of a gear pair as a rank-one system for the compiled kernel.

Sources: docs/theory/floquet.md, "Structure".
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from floquet.gear.axes import GearVariation
from floquet.gear.mesh_gains import MeshGains
from floquet.rank_one.piecewise import fit_pieces
from floquet.rank_one.system import Balance, Gains, RankOneSystem
from lumped.arguments import real_number
from lumped.model.periodic_system import LTVSystem, periodic_system
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
    variation = GearVariation.of(source)
    system = periodic_system(variation.pair, "feedback", cycle=variation.cycle())
    per_load = -(system.structure.normal / system.structure.mass) @ system.reduction.T
    metric = 1.0 / np.abs(per_load)
    levels = ([0.0] if friction_level is None else [0.0, friction_level]) if friction_apart else []
    mesh = MeshGains(system, variation.stiffness_variation, levels, metric)
    phases, fitted, errors, at = fit_pieces(mesh, mesh.edges, mesh.metric, rtol=rtol)
    jumps = np.zeros((phases.size, mesh.jumps.shape[0]))
    jumps[at] = mesh.jumps.T
    blocks, rigid = [], []
    for p in range(mesh.parts):
        four, misfit = _four(fitted, errors, p, mesh)
        w, wd, f, fr = four
        jump = jumps[:, 2 * p : 2 * p + 2]
        blocks.append(Gains(w[:, :3], wd[:, :3], f[:, :3], fr[:, :3], misfit, jump))
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
    fitted: list[FloatArray], errors: FloatArray, part: int, mesh: MeshGains
) -> tuple[list[FloatArray], FloatArray]:
    """w, wd, f and fr of one part out of the list of fitted gains, and their misfits (P, 4)."""
    pieces = errors.shape[0]
    zero, misfit = np.zeros((pieces, 4, 1)), np.zeros((pieces, 4))
    first = 2 * part
    four = [fitted[first], fitted[first + 1], zero, zero]
    misfit[:, :2] = errors[:, first : first + 2]
    if mesh.has_error:
        first += 2 * mesh.parts
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

"""The feedback block of a gear pair: the coordinates that the mesh couples, as a rank-one system.

Sources: docs/theory/floquet.md, "Structure".
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import block_diag, eigh

from floquet.gear.axes import GearVariation
from floquet.gear.gains import MeshGains
from floquet.rank_one.piecewise import fit_pieces
from floquet.rank_one.system import Gains, RankOneSystem
from lumped.arguments import real_number
from lumped.model.periodic_system import LTVSystem, Supports
from lumped.path_of_contact.friction import friction_misfit
from lumped.schema.files import AnyPair
from lumped.typing import FloatArray

MODES = 12
"""Modes of a pair on shafts that are coupled at most; the others move each by itself."""
_EQUAL = 1e-6  # natural frequencies that differ by no more than this part are one


@dataclass(frozen=True, eq=False)
class Feedback:
    """The coordinates that the mesh couples: three on springs, on shafts at most `MODES` modes.

    Attributes
    ----------
    system : x' = A(t) x in these coordinates; modes of a pair on shafts have unit modal mass
    metric : (m,) weights of the norm of errors; they make the frictionless mesh symmetric
    separate : decay rates [1/s] and squares of the natural frequencies (k,) of what moves by itself: on
        springs off the line of action, on shafts the modes that count least
    misfit : (pieces,) bound on the error of the polynomials of mu
    """

    system: LTVSystem
    metric: FloatArray
    separate: tuple[FloatArray, FloatArray]
    misfit: FloatArray


def feedback_system(variation: GearVariation) -> Feedback:
    """Return what the mesh couples of a gear pair."""
    system = LTVSystem.of(variation.pair, "mesh", cycle=variation.cycle(), supports=variation.supports)
    interval = system.cycle.elements.friction.interval
    misfit = variation.friction_scale * friction_misfit(variation.pair, interval)
    if variation.supports == "shafts":
        return _leading_modes(system, misfit)
    s = system.structure
    separate = s.damping[4:] / (2.0 * s.mass[4:]), s.stiffness[4:] / s.mass[4:]
    return Feedback(system, 1.0 / np.abs(system.per_load[0]), separate, misfit)


def _leading_modes(system: LTVSystem, misfit: FloatArray) -> Feedback:
    """The modes that count most of a pair on shafts, the others apart."""
    m = system.deflection.size
    mesh = system.cycle.mean_stiffness * np.outer(system.deflection, system.deflection)
    system = _in_modes(system, eigh(mesh - system.constant[m:, :m])[1])
    whole = _in_modes(system, _turn(system))
    order = np.argsort(-importance(whole), kind="stable")
    leading, rest = (np.sort(part) for part in (order[:MODES], order[MODES:]))
    separate = -0.5 * np.diag(whole.constant[m:, m:])[rest], _squares(whole)[rest]
    return Feedback(_in_modes(whole, np.eye(m)[:, leading]), np.ones(leading.size), separate, misfit)


def _in_modes(system: LTVSystem, modes: FloatArray) -> LTVSystem:
    """The same in the coordinates whose unit vectors are the columns of ``modes`` (m, k), orthonormal."""
    both = block_diag(modes, modes)
    return replace(
        system,
        coordinates=tuple(f"mode_{j + 1}" for j in range(modes.shape[1])),
        constant=both.T @ system.constant @ both,
        torque_pinion=system.torque_pinion @ both,
        torque_gear=system.torque_gear @ both,
        deflection=system.deflection @ modes,
        reduction=modes.T @ system.reduction,
        gears=system.gears @ modes,
        gyroscopic=modes.T @ system.gyroscopic @ modes,
    )


def _squares(system: LTVSystem) -> FloatArray:
    """Squares of the natural frequencies (m,) with the mean stiffness of the mesh, without friction."""
    v, m = system.deflection, system.deflection.size
    return np.asarray(system.cycle.mean_stiffness * v**2 - np.diag(system.constant[m:, :m]))


def _turn(system: LTVSystem) -> FloatArray:
    """Combinations (m, m) of modes of equal frequency: one has all deflection, one all gyroscopic moments."""
    squares = _squares(system)
    turn = np.eye(squares.size)
    for group in np.split(
        np.arange(squares.size), 1 + np.flatnonzero(np.diff(squares) > _EQUAL * squares[1:])
    ):
        own = np.ix_(group, group)
        first = system.deflection[group]
        leading = np.column_stack([first, system.gyroscopic[own] @ first, np.eye(group.size)])
        leading /= np.maximum(np.linalg.norm(leading, axis=0), np.finfo(float).tiny)
        turn[own] = np.linalg.qr(leading)[0]
    return turn


def importance(system: LTVSystem) -> FloatArray:
    """Share (m,) of each mode on shafts in the static deflection by the mesh, and what it gets of others.

    By damping and gyroscopic moments, each at the speed where the mesh frequency is that mode's.
    """
    v, squares, g = system.deflection, _squares(system), system.pair.geometry
    share = v**2 / squares / (v**2 / squares).sum()
    omega, m = np.sqrt(squares), squares.size
    damping = system.constant[m:, m:] + g.omega_pinion * system.gyroscopic
    coupling = omega * (np.abs(damping) + omega / system.pair.pinion.teeth * np.abs(system.gyroscopic))
    apart = np.maximum(np.abs(squares[:, None] - squares), coupling + np.finfo(float).tiny)
    ratio = coupling / apart
    np.fill_diagonal(ratio, 0.0)
    return np.asarray(share + np.square(ratio) @ share)


def gear_block(
    source: AnyPair | GearVariation, rtol: float = 1e-11, *, supports: Supports = "springs"
) -> RankOneSystem:
    """Return z = (q, x_p, x_g) of a gear pair, or on shafts modes: z'' + D z' + L z + w v.z + wd v.z' = 0.

    v . z is the dynamic transmission error, on springs with v = (1, 1, -1); w and wd collect what each pair's
    normal load and friction do to each coordinate. Torques and unloaded tooth errors force the motion and do
    not act on its stability. The metric makes the frictionless mesh symmetric: (m_e, m_p, m_g) on springs,
    and one for modes, which have unit modal mass.

    Parameters
    ----------
    source : a gear pair, or a variation from a chart
    rtol : error of the fitted polynomials relative to the largest gain; it becomes part of the error bounds
    supports : of a pair: "springs", its ``bearings``, or its "shafts"
    """
    rtol = real_number("rtol", rtol, 1e-14, 0.1)
    variation = GearVariation.of(source, supports)
    return fitted_block(feedback_system(variation), variation.stiffness_variation, rtol, [])


def fitted_block(feedback: Feedback, factor: float, rtol: float, levels: Sequence[float]) -> RankOneSystem:
    """Feedback with its gains as polynomials; ``factor`` and ``levels`` as in `MeshGains`.

    With levels, what is proportional to mu is ``varied``: a factor on mu costs nothing, and with two levels
    mu may also rise and fall as a whole.
    """
    system, metric, m = feedback.system, feedback.metric, feedback.metric.size
    turning = system.pair.geometry.omega_pinion * system.gyroscopic
    mesh = MeshGains(system, metric, feedback.misfit, factor, levels)
    phases, fitted, errors, at = fit_pieces(mesh, mesh.edges, metric, rtol=rtol)
    jumps = np.zeros((phases.size, mesh.jumps.shape[0]))
    jumps[at] = mesh.jumps.T
    parts = [
        Gains(fitted[k], fitted[k + 1], errors[:, k : k + 2], jumps[:, k : k + 2])
        for k in range(0, len(fitted), 2)
    ]
    return RankOneSystem(
        stiffness=-system.constant[m:, :m],
        damping=-system.constant[m:, m:] - turning,
        v=system.deflection,
        phases=phases,
        gains=parts[0],
        period=system.period,
        metric=metric,
        varied=tuple(parts[1:]),
        gyroscopic=system.period * turning if turning.any() else None,
    )

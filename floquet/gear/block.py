"""The feedback block of a gear pair as a rank-one system for the compiled kernel.

Sources: docs/theory/floquet.md, "Structure".
"""

from __future__ import annotations

import numpy as np

from floquet.gear.axes import GearVariation
from floquet.gear.feedback import feedback_system
from floquet.gear.mesh_gains import MeshGains
from floquet.rank_one.piecewise import fit_pieces
from floquet.rank_one.system import Gains, RankOneSystem
from lumped.arguments import real_number
from lumped.model.periodic_system import Supports
from lumped.schema.files import AnyPair


def gear_block(
    source: AnyPair | GearVariation,
    rtol: float = 1e-11,
    *,
    friction_apart: bool = False,
    friction_level: float | None = None,
    supports: Supports = "springs",
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
    friction_apart : whether what is proportional to mu becomes the ``varied`` part of the system, so that a
        factor on mu costs nothing
    friction_level : with friction apart, a constant |mu| that changes sign at the pitch point; mu less this,
        and this, become two ``varied`` parts, so that mu may also rise and fall as a whole
    supports : of a pair: "springs", its ``bearings``, or its "shafts"
    """
    rtol = real_number("rtol", rtol, 1e-14, 0.1)
    if friction_level is not None:
        friction_level = real_number("friction_level", friction_level, 0.0, 10.0)
    variation = GearVariation.of(source, supports)
    feedback = feedback_system(variation)
    system, m = feedback.system, feedback.system.deflection.size
    per_load = system.reduction @ (system.structure.normal / system.structure.mass)
    metric = 1.0 / np.abs(per_load) if variation.supports == "springs" else np.ones(m)
    turning = system.pair.geometry.omega_pinion * feedback.gyroscopic
    levels = ([0.0] if friction_level is None else [0.0, friction_level]) if friction_apart else []
    mesh = MeshGains(system, variation.stiffness_variation, levels, metric)
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

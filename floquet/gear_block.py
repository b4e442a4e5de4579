"""The feedback block of a gear pair as a rank-one system for the compiled kernel."""

from __future__ import annotations

import numpy as np

from floquet.gear_axes import GearVariation
from floquet.gear_multipliers import mean_mesh_stiffness
from floquet.piecewise import fit_pieces
from floquet.rank_one import RankOneSystem
from floquet.system import FloatArray
from lumped.parameters import GearPair
from lumped.periodic_system import periodic_system


def gear_block(source: GearPair | GearVariation, rtol: float = 1e-11) -> RankOneSystem:
    """Return (q, x_p, x_g) of a gear pair: z'' + D z' + L z + w (v . z) + wd (v . z') = f.

    v = (1, 1, -1), v . z is the dynamic transmission error; w and wd collect what each pair's normal load and
    friction do to each coordinate. The metric is (m_e, m_p, m_g), for which the frictionless mesh is
    symmetric.

    Parameters
    ----------
    source : a gear pair, or a variation from a chart
    rtol : error of the fitted polynomials relative to the largest gain; it becomes part of the error bounds
    """
    variation = GearVariation(source) if isinstance(source, GearPair) else source
    system = periodic_system(variation.pair, "feedback", cycle=variation.cycle())
    T, s, factor = system.period, system.structure, variation.stiffness_variation
    per_load = -(s.normal / s.mass) @ system.reduction.T
    metric = 1.0 / np.abs(per_load)
    mean = mean_mesh_stiffness(system)

    def gains(phases: FloatArray, segment: int) -> tuple[FloatArray, FloatArray]:
        gain = system.gain(phases * T, segment)
        if factor == 1.0:
            return -gain.stiffness, -gain.damping
        total = system.cycle.sample(phases * T, segment).stiffness.sum(axis=0)
        f = ((mean + factor * (total - mean)) / total)[:, None]
        return -gain.stiffness * f, -gain.damping * np.sqrt(f)

    phases, w, wd, errors = fit_pieces(gains, system.cycle.edges / T, metric, rtol=rtol)
    return RankOneSystem(
        stiffness=-np.diag(system.constant[3:, :3]).copy(),
        damping=-np.diag(system.constant[3:, 3:]).copy(),
        v=system.deflection,
        phases=phases,
        w=w,
        wd=wd,
        forcing=system.torque_pinion[3:] * system.pinion_torque,
        fit_errors=errors,
        period=T,
        metric=metric,
    )

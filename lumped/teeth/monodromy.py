"""Maps of perturbations over single mesh cycles of a pair whose teeth differ, about its own static state.

Sources: docs/theory/teeth.md, "Stability".
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from lumped.errors import NumericalError
from lumped.model.periodic_system import LTVSystem
from lumped.schema.pair import GearPair
from lumped.teeth import kernels
from lumped.teeth.contact import Laws, tables
from lumped.teeth.motion import arguments
from lumped.typing import FloatArray


def cycle_maps(pair: GearPair, system: LTVSystem, steps: int) -> Iterator[FloatArray]:
    """The map (2m, 2m) of each mesh cycle of the period, one after the other, in steps of order 4.

    ``system`` gives the coordinates, of any form; ``steps`` is the least number in a cycle.
    """
    own, loaded = tables(Laws(pair), 1.0 / steps, 1), pair.mesh.contact == "loaded"
    m, inertia = len(system.coordinates), system.structure.mass[:2]
    moments = (system.reduction[:, :2] / inertia).T
    lengths = np.diff(own.edges)[:, None, None] * system.period
    rest, unit = system.constant[m:], np.eye(2 * m)
    approach = float(own.constants[0] / own.stiffness.max())
    for cycle in range(own.period):
        gains, approach = kernels.tangents_of_cycle(
            cycle, approach, loaded, own.edges, own.damping, own.friction, *arguments(own)
        )
        if not np.isfinite(gains).all() or not np.isfinite(approach):
            raise NumericalError(
                "At some position no tooth pair can carry the load: check stiffness and errors."
            )
        by_load = system.per_load[0] + gains[..., 6:] @ moments
        a = np.zeros((*gains.shape[:2], 2 * m, 2 * m))
        a[..., :m, m:] = np.eye(m)
        a[..., m:, :] = rest
        for part, columns in ((slice(0, m), slice(0, 3)), (slice(m, 2 * m), slice(3, 6))):
            force = gains[..., columns]
            rise = force[..., :1] * by_load + force[..., 1:] @ system.per_load[1:]
            a[..., m:, part] += rise[..., None] * system.deflection
        start, middle, end = (a[:, node] for node in range(3))
        one = start
        two = middle @ (unit + 0.5 * lengths * one)
        three = middle @ (unit + 0.5 * lengths * two)
        four = end @ (unit + lengths * three)
        maps = unit + lengths / 6.0 * (one + 2.0 * two + 2.0 * three + four)
        while maps.shape[0] > 1:
            odd = maps[-1:] if maps.shape[0] % 2 else maps[:0]
            maps = np.concatenate([maps[1::2] @ maps[: maps.shape[0] // 2 * 2 : 2], odd])
        yield maps[0]

"""The solutions of this gear pair against finer ones: steps, tolerances, sampling.

Sources: Oberkampf and Roy, Verification and Validation in Scientific Computing, 2010, chapter 8.
"""

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

import multibody
from floquet import gear_pair_system, monodromy
from lumped import GearPair
from lumped.model.periodic_system import periodic_system
from lumped.model.propagation import STAGES, STEP_ANGLE, step_maps
from lumped.model.steady import periodic_cycle
from lumped.typing import FloatArray

_SAMPLES = 64


class Level(NamedTuple):
    """A resolution: name, difference from the finest resolution, and whether the report uses it."""

    setting: str
    error: float
    used: bool = False


class Refinement(NamedTuple):
    """One solution at several resolutions, from coarse to fine; the one in use has to keep the limit."""

    key: str
    subject: str
    measure: str
    limit: float
    levels: tuple[Level, ...]

    @property
    def passes(self) -> bool:
        """Whether the used resolution is within its limit and refining has brought the error down to it."""
        first = self.levels[0].error
        used = next(level.error for level in self.levels if level.used)
        return math.isfinite(used) and used <= self.limit and used <= max(first, self.limit)


def refinements(pair: GearPair, samples: int) -> Iterator[Refinement]:
    """Refine every kind of solution that the report uses, ``samples`` per cycle of its periodic motion."""
    yield Refinement(
        "steady_state",
        "periodic motion: order of the steps",
        f"displacements at the start of the cycle against {STAGES + 2} stages, over the largest",
        1e-9,  # far below every difference that is discussed
        tuple(_stages(pair)),
    )
    yield Refinement(
        "sampling",
        "periodic motion: samples per mesh cycle",
        f"peak to peak of the transmission error against {8 * samples} samples, relative",
        5e-4,  # half a unit of the third digit, the last one shown
        tuple(_sampling(pair, samples)),
    )
    yield Refinement(
        "multibody",
        "exact multibody model, a mesh cycle from the lumped periodic motion: tolerance",
        "transmission error against rtol 1e-10, largest difference over the peak to peak",
        1e-4,  # a hundredth of the smallest difference of the models that is discussed
        tuple(_tolerances(pair)),
    )
    # By two methods: one against itself at a sharper tolerance takes the same steps, and tells nothing.
    system = gear_pair_system(pair, "mesh")
    other, gauss = (monodromy(system, 1e-8, method=method).matrix for method in ("dop853", "gauss"))
    error = float(np.linalg.norm(gauss - other)) / float(np.linalg.norm(other))
    yield Refinement(
        "monodromy",
        "monodromy matrix: method",
        "matrix by Gauss collocation against that by Dormand and Prince, order 8, relative to its norm",
        1e-7,  # ten times what is asked for: the norm of the comparison is not the balanced one
        (Level("rtol 1e-08, Gauss", error, True),),
    )


def _stages(pair: GearPair) -> Iterator[Level]:
    """Start of the periodic motion by Gauss methods of rising order."""
    system = periodic_system(pair, "elastic")

    def displacements(stages: int) -> FloatArray:
        maps = step_maps(system, np.zeros((system.size, 0)), step_angle=STEP_ANGLE, stages=stages)
        phi, forced = maps.over_all
        return np.linalg.solve(np.eye(system.size) - phi, forced[:, 0])[: system.size // 2]

    finest = displacements(STAGES + 2)
    for stages in range(1, STAGES + 1):
        error = float(np.abs(displacements(stages) - finest).max() / np.abs(finest).max())
        yield Level(f"Gauss, {stages} stages, order {2 * stages}", error, stages == STAGES)


def _sampling(pair: GearPair, samples: int) -> Iterator[Level]:
    finest = periodic_cycle(pair, 8 * samples).peak_to_peak["dte"]
    for count in (samples // 4, samples, 2 * samples):
        span = periodic_cycle(pair, count).peak_to_peak["dte"]
        yield Level(f"{count} samples", abs(span / finest - 1.0), count == samples)


def _tolerances(pair: GearPair) -> Iterator[Level]:
    reference, *runs = (
        multibody.simulate(
            pair, 1, samples_per_cycle=_SAMPLES, rtol=rtol, initial="periodic", friction_velocity=None
        )["dte"].to_numpy()
        for rtol in (1e-10, 1e-5, 1e-6, 1e-8)
    )
    for rtol, run in zip((1e-5, 1e-6, 1e-8), runs, strict=True):
        error = float(np.abs(run - reference).max() / np.ptp(reference))
        yield Level(f"rtol {rtol:.0e}", error, rtol == 1e-8)

"""The solutions of this gear pair against finer ones: steps, tolerances, sampling.

Sources: Oberkampf and Roy, Verification and Validation in Scientific Computing, 2010, chapter 8.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

import multibody
from floquet import gear_pair_system, monodromy
from lumped import GearPair
from lumped.arguments import whole_number
from lumped.model.periodic_system import LTVSystem, periodic_system
from lumped.model.propagation import STAGES, STEP_ANGLE, step_maps
from lumped.model.steady import periodic_cycle
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.typing import FloatArray

_SAMPLES = 64


@dataclass(frozen=True)
class Level:
    """One resolution of a refinement.

    Attributes
    ----------
    setting : the resolution in words
    error : difference from the finest one, see ``Refinement.measure``
    used : whether the report's numbers are computed with it
    """

    setting: str
    error: float
    used: bool = False


@dataclass(frozen=True)
class Refinement:
    """One solution of this gear pair at several resolutions.

    Attributes
    ----------
    key : stable name for programs
    subject : the solution
    measure : what the error is of, and relative to what
    levels : from coarse to fine
    limit : largest error of the resolution that is used
    reason : why the limit is what it is
    """

    key: str
    subject: str
    measure: str
    levels: tuple[Level, ...]
    limit: float
    reason: str

    @property
    def error(self) -> float:
        """Error of the resolution that is used."""
        return next(level.error for level in self.levels if level.used)

    @property
    def passes(self) -> bool:
        """Whether the used resolution is within its limit and refining has brought the error down to it."""
        first, used = self.levels[0].error, self.error
        return math.isfinite(used) and used <= self.limit and used <= max(first, self.limit)


def refinements(pair: AnyPair, samples: int) -> tuple[Refinement, ...]:
    """Refine every kind of solution that the report uses.

    Parameters
    ----------
    pair : the gear pair
    samples : per mesh cycle of the report's periodic motion

    Raises
    ------
    NumericalError : a model fails; the text says what to try
    """
    pair = load_gear_pair(pair)
    samples = whole_number("samples", samples, 8, 8192)
    others = (study(pair) for study in (_multibody, _monodromy))
    return (_stages(pair), _sampling(pair, samples), *others)


def _span(pair: GearPair, samples: int) -> float:
    return periodic_cycle(pair, samples).peak_to_peak["dte"]


def _periodic_state(system: LTVSystem, stages: int) -> FloatArray:
    """State (10,) at the start of the periodic motion, bearings and mesh held, by a Gauss method."""
    maps = step_maps(system, np.zeros((system.size, 0)), step_angle=STEP_ANGLE, stages=stages)
    phi, forced = maps.over_all()
    return np.asarray(np.linalg.solve(np.eye(system.size) - phi, forced[:, 0]), dtype=np.float64)


def _stages(pair: GearPair) -> Refinement:
    system = periodic_system(pair, "elastic")
    finest = _periodic_state(system, STAGES + 2)
    scale = np.abs(finest[: system.size // 2]).max()
    levels = []
    for stages in range(1, STAGES + 1):
        found = _periodic_state(system, stages)
        error = float(np.abs(found - finest)[: system.size // 2].max() / scale)
        levels.append(Level(f"Gauss, {stages} stages, order {2 * stages}", error, stages == STAGES))
    return Refinement(
        "steady_state",
        "periodic motion: order of the steps",
        f"displacements at the start of the cycle against {STAGES + 2} stages, over the largest",
        tuple(levels),
        1e-9,
        "far below every difference that is discussed",
    )


def _sampling(pair: GearPair, samples: int) -> Refinement:
    finest = 8 * samples
    spans = {count: _span(pair, count) for count in (samples // 4, samples, 2 * samples, finest)}
    levels = [
        Level(f"{count} samples", abs(span / spans[finest] - 1.0), count == samples)
        for count, span in spans.items()
        if count != finest
    ]
    return Refinement(
        "sampling",
        "periodic motion: samples per mesh cycle",
        f"peak to peak of the transmission error against {finest} samples, relative",
        tuple(levels),
        5e-4,
        "half a unit of the third digit, the last one shown; samples are doubled until this holds",
    )


def _over_tolerance(error: Callable[[float], float], *tolerances: float) -> tuple[Level, ...]:
    """Levels of an integrator; the report uses the last tolerance."""
    return tuple(Level(f"rtol {rtol:.0e}", error(rtol), rtol == tolerances[-1]) for rtol in tolerances)


def _against(dte: Callable[[float], FloatArray], finest: float) -> Callable[[float], float]:
    """Largest difference of the transmission error to the finest run, over the peak to peak."""
    reference = dte(finest)
    return lambda rtol: float(np.abs(dte(rtol) - reference).max() / np.ptp(reference))


def _multibody(pair: GearPair) -> Refinement:
    def dte(rtol: float) -> FloatArray:
        run = multibody.simulate(
            pair, 1, samples_per_cycle=_SAMPLES, rtol=rtol, initial="periodic", friction_velocity=None
        )
        return np.asarray(run["dte"].to_numpy(), dtype=np.float64)

    return Refinement(
        "multibody",
        "exact multibody model, a mesh cycle from the lumped periodic motion: tolerance",
        "transmission error against rtol 1e-10, largest difference over the peak to peak",
        _over_tolerance(_against(dte, 1e-10), 1e-5, 1e-6, 1e-8),
        1e-4,
        "a hundredth of the smallest difference of the models that is discussed",
    )


def _monodromy(pair: GearPair) -> Refinement:
    """By two methods: one against itself at a sharper tolerance takes the same steps, and tells nothing."""
    system = gear_pair_system(pair, "mesh")
    other, found = (monodromy(system, 1e-8, method=method).matrix for method in ("dop853", "gauss"))
    error = float(np.linalg.norm(found - other)) / float(np.linalg.norm(other))
    return Refinement(
        "monodromy",
        "monodromy matrix: method",
        "matrix by Gauss collocation against that by Dormand and Prince, order 8, relative to its norm",
        (Level("rtol 1e-08, Gauss", error, True),),
        1e-7,
        "ten times what is asked for: the norm of the comparison is not the balanced one",
    )

"""The solutions of this gear pair against finer ones: steps, tolerances, sampling.

Sources: Oberkampf and Roy, Verification and Validation in Scientific Computing, 2010, chapter 8.
"""

from __future__ import annotations

from collections.abc import Callable

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
from validation.verification.checks import Level, Refinement, refinement

_SAMPLES = 64


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
    return refinement("steady_state", levels, stages=STAGES + 2)


def _sampling(pair: GearPair, samples: int) -> Refinement:
    finest = 8 * samples
    spans = {count: _span(pair, count) for count in (samples // 4, samples, 2 * samples, finest)}
    levels = [
        Level(f"{count} samples", abs(span / spans[finest] - 1.0), count == samples)
        for count, span in spans.items()
        if count != finest
    ]
    return refinement("sampling", levels, samples=finest)


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

    levels = _over_tolerance(_against(dte, 1e-10), 1e-5, 1e-6, 1e-8)
    return refinement("multibody", levels)


def _monodromy(pair: GearPair) -> Refinement:
    """By two methods: one against itself at a sharper tolerance takes the same steps, and tells nothing."""
    system = gear_pair_system(pair, "mesh")
    other, found = (monodromy(system, 1e-8, method=method).matrix for method in ("dop853", "gauss"))
    error = float(np.linalg.norm(found - other)) / float(np.linalg.norm(other))
    return refinement("monodromy", (Level("rtol 1e-08, Gauss", error, True),))

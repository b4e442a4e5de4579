"""Are four springs enough? The six-degree-of-freedom model against the same pair on its shafts.

Four lumped models differ in their supports alone: the springs of the parameters, the springs and masses to
which the shafts condense at rest and at the mesh frequency, and the shafts with their modes. The machine in
exudyn, with beams of its own and the exact contact, shows what all of them leave out; with the linear mesh it
is compared with the last one in every report (``on_shafts`` of ``validation.verification.checks``).

Sources: docs/theory/shafts.md, "Four springs".
"""

from __future__ import annotations

import contextlib
from dataclasses import dataclass

import numpy as np
import xarray as xr

import lumped
import multibody
from floquet.gear.axes import operating_rpm
from lumped import GearPair
from lumped.errors import NumericalError, ParameterError
from lumped.labelling import labelled_dataset
from lumped.model.periodic_system import Supports
from lumped.model.results import cycle_peak_to_peak
from lumped.model.steady import UNSTABLE, PeriodicSolution, periodic_cycle
from lumped.shafts.pair import highest_frequency
from lumped.typing import FloatArray, Progress

#: Model -> what it is in words.
MODELS = {
    "springs": "four springs as given",
    "condensed": "four springs condensed from the shafts at rest",
    "dynamic": "condensed at the mesh frequency",
    "shafts": "shafts with their modes",
    "machine": "machine in exudyn",
}
#: Quantity over speed -> unit and words.
QUANTITIES = {
    "dte": ("m", "transmission error, peak to peak"),
    "force_p": ("N", "force of the pinion's bearings along the LOA, peak to peak"),
    "force_g": ("N", "force of the gear's bearings along the LOA, peak to peak"),
}
#: Differences over the model on shafts, from which on four springs are a warning, and do not hold.
LIMITS = (0.1, 0.3)
_SAMPLES = 64
#: Speeds at which the machine runs.
_MACHINE_SPEEDS = 5


@dataclass(frozen=True, eq=False)
class FourSprings:
    """Outcome of ``four_springs``.

    Attributes
    ----------
    pair : with ``shafts.max_frequency`` as all models take it
    over_speed : dataset over ``model`` and ``speed`` [rpm]: the quantities of ``QUANTITIES`` and
        ``spectral_radius``; NaN where there is no periodic motion, and at most speeds of the machine
    modes : dataset of ``lumped.shaft_modes``
    """

    pair: GearPair
    over_speed: xr.Dataset
    modes: xr.Dataset

    def off(self, model: str) -> FloatArray:
        """Largest relative difference of any quantity from the model on shafts, over speed; inf: unstable."""
        one, shafts = self.over_speed.sel(model=model), self.over_speed.sel(model="shafts")
        off = np.max([np.abs(one[name] / shafts[name] - 1.0) for name in QUANTITIES], axis=0)
        if model != "machine":
            stable = (one["spectral_radius"] <= UNSTABLE) == (shafts["spectral_radius"] <= UNSTABLE)
            off = np.where(stable & ~np.isnan(off), off, np.inf)
        return np.asarray(off)

    def off_here(self, model: str) -> float:
        """The same at the operating speed."""
        return float(self.off(model)[self._operating])

    def here(self, model: str, name: str) -> float:
        """A quantity of a model at the operating speed; NaN where there is none."""
        return float(self.over_speed[name].sel(model=model)[self._operating])

    @property
    def _operating(self) -> int:
        """Number of the operating speed."""
        return int(np.argmin(np.abs(self.over_speed["speed"].to_numpy() - operating_rpm(self.pair))))

    def ranges(self, *, hold: bool) -> list[tuple[float, float]]:
        """Ranges of speeds at which the springs of the parameters hold, or do not [rpm].

        They end halfway between two speeds.
        """
        speeds, good = self.over_speed["speed"].to_numpy(), (self.off("springs") <= LIMITS[1]) == hold
        middles = np.concatenate([speeds[:1], 0.5 * (speeds[1:] + speeds[:-1]), speeds[-1:]])
        edges = middles[np.flatnonzero(np.diff(good.astype(int), prepend=0, append=0))].tolist()
        return list(zip(edges[::2], edges[1::2], strict=True))


def four_springs(pair: GearPair, speeds_rpm: FloatArray, progress: Progress | None = None) -> FourSprings:
    """Compare the springs of a pair with its shafts.

    Parameters
    ----------
    pair : a validated gear pair with shafts
    speeds_rpm : pinion speeds; the operating speed is added [rpm]
    progress : called with the finished fraction

    Raises
    ------
    ParameterError : the pair has no shafts
    """
    pair = pair.with_({"shafts.max_frequency": highest_frequency(pair) / (2.0 * np.pi)})
    # What hangs on a gear's shaft by a coupling does not turn with it at mesh frequencies.
    at_rest = lumped.condensed_bearings(pair.with_({"shafts.motor": None, "shafts.load": None}))
    speeds = np.union1d(np.asarray(speeds_rpm, dtype=float), operating_rpm(pair))
    table = _over_speed(pair, at_rest, speeds, progress)
    step = max(1, round(speeds.size / _MACHINE_SPEEDS))
    here = int(np.argmin(np.abs(speeds - operating_rpm(pair))))
    for j in sorted({*range(step // 2, speeds.size, step), here}):
        _machine_at(table, pair, j, float(speeds[j]))
    about = QUANTITIES | {"spectral_radius": ("1", "largest modulus of the multipliers")}
    over_speed = labelled_dataset(
        {name: (("model", "speed"), values, *about[name]) for name, values in table.items()},
        {"model": (list(MODELS), "1", "model"), "speed": (speeds, "rpm", "pinion speed")},
    )
    return FourSprings(pair, over_speed, lumped.shaft_modes(pair))


def _over_speed(
    pair: GearPair, at_rest: GearPair, speeds: FloatArray, progress: Progress | None
) -> dict[str, FloatArray]:
    """Quantities, (models, speeds)."""
    table = {name: np.full((len(MODELS), speeds.size), np.nan) for name in (*QUANTITIES, "spectral_radius")}
    for j, rpm in enumerate(speeds):
        here, rest = (one.with_({"operating.pinion_speed": float(rpm)}) for one in (pair, at_rest))
        models: dict[str, tuple[GearPair, Supports]] = {
            "springs": (here, "springs"),
            "condensed": (rest, "springs"),
            "shafts": (here, "shafts"),
        }
        # Where a shaft resists like no spring at all, there is no such pair.
        with contextlib.suppress(ParameterError):
            dynamic = lumped.condensed_bearings(here, 1.0 / here.geometry.mesh_period)
            models["dynamic"] = (dynamic, "springs")
        for name, (one, supports) in models.items():
            try:
                found = periodic_cycle(one, _SAMPLES, supports=supports)
            except NumericalError:
                continue
            _enter(table, list(MODELS).index(name), j, found)
        if progress is not None:
            progress((j + 1) / speeds.size)
    return table


def _enter(table: dict[str, FloatArray], i: int, j: int, found: PeriodicSolution) -> None:
    values = found.values
    table["dte"][i, j] = found.peak_to_peak["dte"]
    table["force_p"][i, j] = np.ptp(values["bearing_force_x_p"])
    table["force_g"][i, j] = np.ptp(values["bearing_force_x_g"])
    table["spectral_radius"][i, j] = found.spectral_radius


def _machine_at(table: dict[str, FloatArray], pair: GearPair, j: int, rpm: float) -> None:
    at = pair.with_({"operating.pinion_speed": rpm})
    try:
        run = multibody.steady_state(at, samples_per_cycle=_SAMPLES, supports="shafts")
    except NumericalError:
        return
    row = list(MODELS).index("machine")
    table["dte"][row, j] = cycle_peak_to_peak(run, "dte", at.geometry.mesh_period)
    table["force_p"][row, j] = np.ptp(run["bearing_force_x_p"].to_numpy())
    table["force_g"][row, j] = np.ptp(run["bearing_force_x_g"].to_numpy())

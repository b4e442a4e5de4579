"""Machines whose teeth are drawn of an assumed tolerance class, for a pair that states no tooth errors.

A parameter file without deviations has perfect teeth. A real pair has teeth of some class of ISO 1328-1. The
class is assumed, as for K_v of ISO 6336-1: ``ASSUMED_TOLERANCE_CLASS``. Each machine has other teeth on both
gears and, where the inputs are varied, other inputs. Each machine is compared with its twin with perfect
teeth: the ratio of both says what the teeth do, and the ratios widen the range of the inputs.

Each motion is that of ``predict`` over the hunting period, as for the teeth of a file, but for steps that are
``STEP_FACTOR`` times as long. They err by 1 % at most (docs/verification/uncertainty.md), while the machines
differ by tens of per cent. The linear motion takes less time, too, but with the friction law of Benedict and
Kelley it changes with the number of samples: the peak to peak of 19/41 with drawn teeth is 50, 97 and 201 um
for 32, 64 and 256 samples, 50 um by ``predict``.

Source: prediction interval of one further value, log-normal with unknown mean and variance; Hahn and Meeker,
Statistical Intervals, 1991, section 4.7.
"""

from __future__ import annotations

import math

import numpy as np
import xarray as xr
from scipy.special import stdtrit

from lumped.errors import NumericalError
from lumped.labelling import Variable, labelled_dataset
from lumped.model.dynamic_factor import ASSUMED_TOLERANCE_CLASS
from lumped.schema.meeting_teeth import period_of
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray
from validation.prediction.motion import QUANTITIES, Motion, predicted, predicted_by_long_steps
from validation.prediction.uncertainty import PERCENTILES, TEETH, Sampled, each_sample

#: Results whose range the ratios widen.
WIDENED = ("dynamic_factor", "tooth_load", "bearing_rms")
#: Least number of machines of a range. With three, Student's t makes the range twice as wide as with many.
LEAST_MACHINES = 3
#: Length of the steps of the motion with drawn teeth over that of ``predict``.
STEP_FACTOR = 4
#: Name of the transmission error over the period of the teeth.
REVOLUTION = "revolution_dte_peak_to_peak"
#: Number of equally probable ratios that the samples of the inputs are multiplied by.
_RATIOS = 64


def with_assumed_class(pair: GearPair, pinion_seed: int = 1, gear_seed: int = 2) -> GearPair:
    """Return the pair with the teeth of both gears drawn of the assumed class."""
    seeds = {"pinion": pinion_seed, "gear": gear_seed}
    return pair.with_(
        {
            f"{gear}.deviations": {"tolerance_class": ASSUMED_TOLERANCE_CLASS, "seed": seed}
            for gear, seed in seeds.items()
        }
    )


def assumed_teeth(
    pair: GearPair, at_operating_speed: xr.Dataset | None, machines: int, seconds: float | None = None
) -> xr.Dataset:
    """Return results of machines with teeth drawn of the assumed class, over ``machine``.

    Parameters
    ----------
    pair : the gear pair, with like teeth
    at_operating_speed : result of ``uncertainty``, which ranks the inputs. None: all machines have the inputs
        as given, and the teeth alone differ
    machines : number of machines
    seconds : processor time after which no further machine begins [s]

    Returns
    -------
    xarray.Dataset with ``REVOLUTION`` [m] and, for each result q of ``WIDENED``, ``q_ratio`` [-]: with drawn
    teeth over with perfect teeth and the same inputs. NaN: the result with perfect teeth is zero.
    Attributes: ``tolerance_class``; ``samples``, ``taken`` and ``asked`` as in ``speed_band``;
    ``contact_lost``, the number of machines whose mesh force reaches zero; ``period`` of the teeth in mesh
    cycles; ``inputs``, "varied" or "as given"
    """
    sampled = drawn_machines(pair, at_operating_speed, machines, seconds)
    return results_of_machines(pair, sampled, varied=at_operating_speed is not None)


def drawn_machines(
    pair: GearPair,
    at_operating_speed: xr.Dataset | None,
    machines: int,
    seconds: float | None,
    part: slice = slice(None),
) -> Sampled[list[float]]:
    """Return the results of each machine. Arguments as in `assumed_teeth` and `each_sample`."""
    drawn = with_assumed_class(pair)
    return each_sample(drawn, at_operating_speed, machines, _beside_twin, seconds, part)


def results_of_machines(pair: GearPair, sampled: Sampled[list[float]], *, varied: bool) -> xr.Dataset:
    """Return the dataset of `assumed_teeth`. ``varied``: the inputs are varied."""
    table = np.array(sampled.results, dtype=float).reshape(-1, len(WIDENED) + 2)
    unit, text = TEETH[REVOLUTION]
    variables: dict[str, Variable] = {REVOLUTION: ("machine", table[:, 0], unit, text)}
    for column, name in enumerate(WIDENED, 1):
        words = f"{QUANTITIES[name][1]}, with drawn teeth over with perfect teeth"
        variables[f"{name}_ratio"] = ("machine", table[:, column], "1", words)
    attributes = {
        "samples": len(table),
        "taken": sampled.taken,
        "asked": sampled.asked,
        "contact_lost": int(table[:, -1].sum()),
        "period": period_of(with_assumed_class(pair)),
        "tolerance_class": ASSUMED_TOLERANCE_CLASS,
        "inputs": "varied" if varied else "as given",
    }
    return labelled_dataset(variables, {}, attributes)


def _beside_twin(machine: GearPair) -> list[float]:
    """Transmission error over the period of the teeth, ratios to the twin, and whether contact is lost."""
    drawn = predicted_by_long_steps(machine, STEP_FACTOR)
    twin = predicted(machine.healthy)
    if twin.motion is Motion.LINEAR:
        raise NumericalError("The linear motion stands in, in which teeth may pull.")
    ratios = [
        drawn.numbers[name] / twin.numbers[name] if twin.numbers[name] > 0.0 else math.nan for name in WIDENED
    ]
    return [drawn.peak_to_peak, *ratios, float(drawn.contact_lost)]


def quantiles(values: FloatArray, shares: FloatArray) -> FloatArray:
    """Return the quantiles of one further value, log-normal like the positive ``values`` (n,).

    With few values their own 5 and 95 % are too narrow: of eight machines a ninth lies between the least and
    the largest with a probability of 7/9. Student's t has the right probability for every n.
    """
    logarithms = np.log(values)
    count = logarithms.size
    scale = logarithms.std(ddof=1) * math.sqrt(1.0 + 1.0 / count)
    return np.asarray(np.exp(logarithms.mean() + stdtrit(count - 1, shares) * scale))


def has_range(teeth: xr.Dataset) -> bool:
    """Return whether there are enough machines for a range."""
    return int(teeth.attrs["samples"]) >= LEAST_MACHINES


def revolution_range(teeth: xr.Dataset) -> tuple[float, float, float]:
    """Return 5, 50 and 95 % of the transmission error over the period of drawn teeth [m]."""
    low, middle, high = quantiles(teeth[REVOLUTION].to_numpy(), np.array(PERCENTILES) / 100.0).tolist()
    return low, middle, high


def widened(samples: xr.Dataset, teeth: xr.Dataset, name: str) -> tuple[float, float]:
    """Return 5 and 95 % of a result with the uncertain inputs and drawn teeth.

    Each sample of the inputs is multiplied by each of ``_RATIOS`` equally probable ratios. A ratio above 1
    acts on the upper end alone and a ratio below 1 on the lower end alone: better teeth than those of the
    class are possible, so the range of perfect teeth is always inside.
    """
    low, _, high = samples[f"{name}_percentile"].to_numpy().tolist()
    ratios = teeth[f"{name}_ratio"].to_numpy()
    if not (has_range(teeth) and np.isfinite(ratios).all() and math.isfinite(low)):
        return low, high
    probable = quantiles(ratios, (np.arange(_RATIOS) + 0.5) / _RATIOS)
    values = samples[name].to_numpy()[:, None]
    least = float(np.percentile(values * np.minimum(probable, 1.0), PERCENTILES[0]))
    most = float(np.percentile(values * np.maximum(probable, 1.0), PERCENTILES[-1]))
    if name == "dynamic_factor":
        least = max(least, 1.0)  # the largest mesh force is not below the mean one
    return min(least, low), max(most, high)

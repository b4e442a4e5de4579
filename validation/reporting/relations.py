"""Relations that must hold between the results of a report, and the failed checks of the program."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import suppress

import numpy as np
import xarray as xr

from lumped.errors import NumericalError
from lumped.outcomes import Absent
from validation.prediction.motion import NOTHING, Prediction
from validation.reporting.results import Results

#: Relative rounding that a relation allows.
ROUNDING = 1e-9
#: A curve over speed passes through the value of the operating speed within this share: the samples differ.
_SAME = 2e-3
#: Mean moment over the torque that is the error of a mean of samples: friction jumps between two samples.
_SAMPLED_MOMENT = 2e-3


def failed_checks(results: Results) -> tuple[str, ...]:
    """Return the failed checks of the program: same equations, conservation laws, relations."""
    failures = () if isinstance(results.check, Absent) else results.check.failures
    return (*(judgement.check for judgement in failures), *broken_relations(results))


def broken_relations(results: Results) -> tuple[str, ...]:
    """Return the relations between results that do not hold, as phrases."""
    broken: list[str] = []
    for relations in (_of_numbers, _of_the_motion, _of_the_sweep, _of_samples):
        with suppress(NumericalError):  # no result, no relation: page 1 says that the result is missing
            broken += relations(results)
    return tuple(broken)


def _of_numbers(results: Results) -> Iterator[str]:
    """Bounds of the numbers of page 1."""
    numbers = results.prediction.numbers
    if numbers["dynamic_factor"] < 1.0 - ROUNDING:
        yield f"the dynamic factor {numbers['dynamic_factor']:.4g} is below 1"
    if not 0.0 <= numbers["least_force"] <= 1.0 + ROUNDING:
        yield f"the smallest mesh force is {numbers['least_force']:.4g} of the mean one"
    # Where the linear motion stands in, teeth that pull may do more work than the shafts bring.
    if not results.prediction.reason and not 0.0 < numbers["efficiency"] <= 1.0 + ROUNDING:
        yield f"the efficiency is {numbers['efficiency']:.4g}"


def _of_the_motion(results: Results) -> Iterator[str]:
    """Numbers of page 1 against the motion over time."""
    prediction = results.prediction
    imbalance = moments_on_the_pinion(prediction)
    if abs(imbalance) > _SAMPLED_MOMENT:
        yield f"driving torque, mesh force and friction do not balance by {imbalance:.2g} of the torque"
    dte = prediction.cycle["dte"].to_numpy()
    sampled = float(np.ptp(dte))
    least = sampled * (1.0 - ROUNDING) - _rounding(results)
    # Samples that do not resolve the fastest vibration may miss it as a whole.
    resolved = results.vibrations <= 0.5 * prediction.plain.time.size / prediction.mesh_cycles
    largest = (1.05 if resolved else 2.0) * sampled + 1e-12
    if not least <= prediction.peak_to_peak <= largest:
        yield "the peak to peak is not that of the motion"
    rms = prediction.numbers["bearing_rms"]
    orders = prediction.bearing_orders
    if np.sum(orders**2) / 2.0 > rms**2 * (1.0 + 1e-6) + (NOTHING * prediction.static_force) ** 2:
        yield "the orders of the bearing force carry more than its rms"


def moments_on_the_pinion(prediction: Prediction) -> float:
    """Mean moment of torque, mesh force and friction on the pinion, over the driving torque [-]; 0.

    The rotation of the pinion repeats, so T_p = r_bp <N> + <sum F_n xi_n>.
    """
    cycle = prediction.plain
    moment = cycle.values["friction_force"] * cycle.values["position"]
    carried = prediction.pair.geometry.base_radius_pinion * prediction.mean_force
    torque = float(cycle.attributes.get("pinion_torque", prediction.pair.operating.pinion_torque))
    return (carried + float(moment.sum(axis=0).mean())) / torque - 1.0


def _of_the_sweep(results: Results) -> Iterator[str]:
    """The curve over speed against the linear motion at the operating speed, of a pair on springs."""
    linear = results.linear
    if isinstance(linear, Absent) or results.pair.shafts is not None:
        return
    on_curve = float(results.sweep.interp(speed=results.operating_rpm)["dte_peak_to_peak"])
    computed = float(linear.attrs["dte_peak_to_peak"])
    if abs(on_curve - computed) > _SAME * computed + _rounding(results):
        yield "the curve over speed misses the value at the operating speed"


def _of_samples(results: Results) -> Iterator[str]:
    """The samples of the inputs against the prediction."""
    samples = results.uncertainty
    if not isinstance(samples, xr.Dataset):
        return
    for name, value in results.like.numbers.items():
        if abs(samples.attrs[f"given_{name}"] - value) > ROUNDING * max(abs(value), 1e-300):
            yield f"the samples were taken about another {name}"
        low, middle, high = samples[f"{name}_percentile"].to_numpy()
        if math.isfinite(middle) and not low <= middle <= high:
            yield f"the percentiles of {name} are not in order"


def _rounding(results: Results) -> float:
    """Rounding of the transmission error [m]: a share of its largest value."""
    return NOTHING * float(np.abs(results.prediction.cycle["dte"].to_numpy()).max())

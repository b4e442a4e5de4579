"""How well do 128 samples of the uncertain inputs tell the percentiles, and 32 samples the band over speed?

    python -m benchmarks.bench_uncertainty [19/41] [31/57] [28/28] [shafts] [order] [band] [rank] [classes]
        [--reference 4096] [--pairs 0 20]

The tables of docs/verification/uncertainty.md. Errors are root mean squares over the seeds, in per cent of
the range from 5 to 95 % of the reference.
"""

from __future__ import annotations

import argparse
import time
import warnings
from collections.abc import Iterator, Sequence
from functools import cache
from unittest import mock

import numpy as np
import xarray as xr

from floquet.gear.axes import speed_range
from lumped import GearPair, load_gear_pair
from validation.exchange.new_pair_file import new_pair
from validation.prediction import uncertainty as module
from validation.prediction.assumed_teeth import (
    REVOLUTION,
    WIDENED,
    assumed_teeth,
    has_range,
    revolution_range,
    widened,
    with_assumed_class,
)
from validation.prediction.inputs import SEED_FIELDS, uncertain_inputs
from validation.prediction.motion import predicted
from validation.prediction.uncertainty import speed_band, uncertainty, varied

BEARINGS = [{"position": z, "loa_stiffness": 2e8, "oloa_stiffness": 2e8} for z in (30, 150)]
SHAFT = {"segments": [{"length": 300, "diameter": 30}], "gear_position": 90, "bearings": BEARINGS}
TRAIN = {"position": 300, "inertia": 0.01, "coupling_stiffness": 1e5}
#: Those of examples/26_four_springs.py, slender.
SLENDER = {"damping_ratio": 0.02, "max_frequency": 8000, "pinion": SHAFT, "gear": SHAFT}
PAIRS = {
    "19/41": (new_pair("19/41", 2.5, 20.0, 1450.0, 80.0), 8),
    "31/57": (new_pair("31/57", 3.0, 25.0, 12_000.0, 150.0), 4),
    "28/28": (load_gear_pair("nasa_28_28"), 4),
}
PAIRS["shafts"] = PAIRS["28/28"][0].with_(shafts=SLENDER | {"motor": TRAIN, "load": TRAIN}), 4
QUANTITIES = ("dte_peak_to_peak", "dynamic_factor", "tooth_load", "bearing_rms", "efficiency")
ENDS = (5.0, 95.0)
SAMPLES = 128
REFERENCE_SEED = 1000


def line(*cells: object) -> None:
    """A line of a table."""
    print(
        "|",
        " | ".join(f"{one:.4g}" if isinstance(one, float) else str(one) for one in cells),
        "|",
        flush=True,
    )


def ends_of(result: xr.Dataset, name: str, kind: str = "percentile") -> np.ndarray:
    return result[f"{name}_{kind}"].sel(percentile=list(ENDS)).to_numpy()


@cache
def reference_of(name: str, count: int) -> xr.Dataset:
    return uncertainty(PAIRS[name][0], count, REFERENCE_SEED)


def samples(name: str, reference: int) -> None:
    """Percentiles of 128 samples against those of many."""
    start = time.process_time()
    pair, seeds = PAIRS[name]
    many = reference_of(name, reference)
    few = [uncertainty(pair, SAMPLES, seed + 1) for seed in range(seeds)]
    counts = ", ".join(f"{many.attrs[what]} {what}" for what in ("refused", "contact_lost", "unstable"))
    took = time.process_time() - start
    print(f"\n{name}, {reference} samples ({counts}), {seeds} seeds of {SAMPLES}; {took:.0f} s\n")
    line("result", "given", "5 %", "95 %", "error of 5 %", "error of 95 %", "interval holds it")
    for quantity in QUANTITIES:
        wanted = ends_of(many, quantity)
        errors_of_ends = np.array([ends_of(one, quantity) - wanted for one in few]) / np.ptp(wanted)
        within = np.array([ends_of(one, quantity, "interval") for one in few])
        is_inside = (within[..., 0] <= wanted) & (wanted <= within[..., 1])
        errors = (100.0 * np.sqrt(np.mean(errors_of_ends**2, axis=0))).tolist()
        value_as_given = float(many.attrs[f"given_{quantity}"])
        line(quantity, value_as_given, *wanted.tolist(), *errors, f"{is_inside.sum()} of {is_inside.size}")


def order(reference: int) -> None:
    """The same for 19/41 with the inputs in the order of the file."""
    reference_of("19/41", reference)
    print("\nInputs in the order of the file:")
    with mock.patch.object(module, "importance_of", lambda ends: -np.arange(float(len(ends)))):
        samples("19/41", reference)


def speeds_between(low: float, high: float, count: int) -> np.ndarray:
    """As the report has them."""
    return np.linspace(low**0.5, high**0.5, count) ** 2


def band(reference: int) -> None:
    """Ends of the band over speed of 19/41 against 128 samples at 61 speeds, in per cent of its width."""
    pair, _ = PAIRS["19/41"]
    result = uncertainty(pair, SAMPLES)
    ends = speed_range(pair)
    many_speeds = speeds_between(*ends, 61)
    many = speed_band(pair, many_speeds, result, 128)
    width = float((many["high"] - many["low"]).mean())
    print("\nBand over speed of 19/41 against 128 samples at 61 speeds, in per cent of its mean width\n")
    line("samples", "speeds", "lower end", "upper end", "most", "s")
    for count, speeds in ((32, 41), (32, 61), (16, 31)):
        few_speeds = speeds_between(*ends, speeds)
        start = time.process_time()
        band_of_few = speed_band(pair, few_speeds, result, count)
        took = time.process_time() - start
        errors_of_band = [
            100.0
            * (np.interp(many_speeds, few_speeds, band_of_few[end].to_numpy()) - many[end].to_numpy())
            / width
            for end in ("low", "high")
        ]
        errors = [float(np.sqrt(np.mean(one**2))) for one in errors_of_band]
        line(count, speeds, *errors, float(np.abs(errors_of_band).max()), took)


#: New pairs that are unlike each other: teeth, module [mm], width [mm], speed [rpm], torque [N m], what else.
NAMED = (
    ("19/41", 2.5, 20.0, 1450.0, 80.0, {}),
    ("25/103", 1.5, 12.0, 1500.0, 10.0, {}),
    ("18/35", 0.5, 5.0, 3000.0, 0.02, {"gears.youngs_modulus": "3 GPa", "gears.density": 1400.0}),
    ("22/95", 14.0, 300.0, 400.0, 12_000.0, {}),
)
DRAWN = 20
DRAWN_SEED = 7


def drawn_pairs() -> Iterator[GearPair]:
    """The named pairs and others of random size, speed and load, half of them with a relief of the tips."""
    rng = np.random.default_rng(DRAWN_SEED)
    for teeth, *numbers, more in NAMED:
        yield new_pair(teeth, *numbers, more)
    for _ in range(DRAWN - len(NAMED)):
        pinion = int(rng.integers(17, 42))
        gear = int(pinion * rng.uniform(1.0, 4.5))
        module = float(f"{np.exp(rng.uniform(0.0, np.log(10.0))):.2g}")
        width = round(module * rng.uniform(6.0, 12.0), 1)
        velocity = np.exp(rng.uniform(0.0, np.log(30.0)))
        diameter = 1e-3 * module * pinion
        speed = round(60.0 * velocity / (np.pi * diameter))
        intensity = np.exp(rng.uniform(np.log(5e6), np.log(40e6)))
        torque = float(f"{0.5e-6 * intensity * width * module * diameter:.3g}")
        pair = new_pair(f"{pinion}/{gear}", module, width, speed, torque)
        if rng.random() < 0.5:
            amount = np.exp(rng.uniform(np.log(5.0), np.log(25.0))) * min(1.0, module / 3.0)
            pair = with_relief(pair, round(float(amount), 1))
        yield pair


def with_relief(pair: GearPair, amount: float) -> GearPair:
    """The pair with an assumed tip relief [um] from the outer point of single contact on."""
    g = pair.geometry
    starts = {
        "pinion": (g.L_XA + g.base_pitch) / g.base_radius_pinion,
        "gear": (g.L_XY - g.L_XD + g.base_pitch) / g.base_radius_gear,
    }
    tips = {
        f"{name}.tip_relief": {"amount": amount, "start_roll_angle": round(float(np.degrees(start)), 2)}
        for name, start in starts.items()
    }
    return pair.with_(tips | {"sources": dict(pair.sources) | dict.fromkeys(tips, "assumed")})


def rank(reference: int) -> None:
    """Share of the samples below the result as given, and the median over it; efficiency as the loss."""
    print("\nRank of the result as given [%], and median over it\n")
    line("pair", *QUANTITIES, "contact lost")
    ranks = []
    for pair in drawn_pairs():
        result = uncertainty(pair, SAMPLES)
        values_as_given = {name: float(result.attrs[f"given_{name}"]) for name in QUANTITIES}
        values_of_samples = {name: result[name].to_numpy() for name in QUANTITIES}
        ranks.append(
            [100.0 * float(np.mean(values_of_samples[name] < values_as_given[name])) for name in QUANTITIES]
        )
        median = [
            float(np.median(values_of_samples[name])) / values_as_given[name] for name in QUANTITIES[:-1]
        ]
        median.append(
            (1.0 - float(np.median(values_of_samples["efficiency"]))) / (1.0 - values_as_given["efficiency"])
        )
        cells = [f"{r:.0f}, {m:.2f}" for r, m in zip(ranks[-1], median, strict=True)]
        line(pair.name, *cells, result.attrs["contact_lost"])
    inside = [int(np.sum((one >= 20.0) & (one <= 80.0))) for one in np.transpose(ranks)]
    line("from 20 to 80 %", *(f"{count} of {len(ranks)}" for count in inside), "")


#: Machines and processor time [s] of a full report with teeth of an assumed class; samples of inputs, fewer
#: than in the report.
MACHINES, LIMIT, FEW = 8, 15.0, 32


def classes(first: int, last: int) -> None:
    """Is a true machine inside the ranges of a report of a pair that states no tooth errors?

    The true machine has drawn inputs and drawn teeth of class 6, other ones than the report draws, and moves
    with unilateral contact.
    """
    names = (REVOLUTION, *WIDENED)
    print("\nTrue machine of class 6 and its place: 0 is 5 %, 1 is 95 % of the range of page 1\n")
    line("pair", "machines of those taken", *names, *(f"{name}, perfect teeth" for name in WIDENED))
    inside = np.zeros((len(names) + len(WIDENED), 2), dtype=int)
    for number, pair in enumerate(drawn_pairs()):
        if not first <= number < last:
            continue
        result = uncertainty(pair, FEW)
        teeth = assumed_teeth(pair, result, MACHINES, LIMIT)
        rng = np.random.default_rng((DRAWN_SEED, number))
        drawn = with_assumed_class(pair, *(int(one) for one in rng.integers(1, 2**31, 2)))
        inputs = [one for one in uncertain_inputs(pair) if one.field not in SEED_FIELDS]
        motion = predicted(varied(drawn, [(one, float(rng.random())) for one in inputs]))
        true = {REVOLUTION: motion.peak_to_peak} | motion.numbers
        ends = [revolution_range(teeth)[::2]] if has_range(teeth) else [(np.nan, np.nan)]
        ends += [widened(result, teeth, name) for name in WIDENED]
        ends += [tuple(ends_of(result, name)) for name in WIDENED]
        places = [
            (true[name] - low) / (high - low)
            for name, (low, high) in zip((*names, *WIDENED), ends, strict=True)
        ]
        line(
            pair.name,
            f"{teeth.attrs['samples']} of {teeth.attrs['taken']}",
            *(f"{place:.2f}" for place in places),
        )
        known = np.isfinite(places)
        inside += np.column_stack([known & (np.abs(np.array(places) - 0.5) <= 0.5), known])
    line("inside", "", *(f"{count} of {total}" for count, total in inside.tolist()))


def main(names: Sequence[str], reference: int, pairs: tuple[int, int]) -> None:
    warnings.simplefilter("ignore")
    tables = {"order": order, "band": band, "rank": rank, "classes": lambda _: classes(*pairs)}
    for name in names or (*PAIRS, *tables):
        tables.get(name, lambda n, name=name: samples(name, n))(reference)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", metavar="TABLE", help="default all")
    parser.add_argument("--reference", type=int, default=4096, help="samples of the reference")
    parser.add_argument(
        "--pairs", nargs=2, type=int, default=(0, DRAWN), help="first pair, and pair to end at"
    )
    given = parser.parse_args()
    main(given.names, given.reference, tuple(given.pairs))

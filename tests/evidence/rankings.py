"""Shares of ``spurcheck.compare`` against plain Monte Carlo: ``python -m tests.evidence.rankings``.

Seven pairs of variants, five results of each. The own program draws independent uniform numbers, one for
every input, and a list of each case, written by hand, says which inputs the variants do not share.
"""

from __future__ import annotations

import argparse
import json
import sys
import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

import spurcheck
from lumped import GearPair
from lumped.errors import SpurcheckError
from tests.unlike_pairs import unlike_pair
from validation.prediction.inputs import uncertain_inputs
from validation.prediction.uncertainty import varied

#: Results, and whether a larger one is better.
RESULTS = {
    "dte_peak_to_peak": False,
    "dynamic_factor": False,
    "tooth_load": False,
    "bearing_rms": False,
    "efficiency": True,
}
#: Largest difference of a share, in points of 100.
LIMIT = 5.0
SAMPLES = 512
FEW = 128
PLAIN = 1000
SEED = 20260101


@dataclass(frozen=True)
class Case:
    """Two variants, and the inputs of which each variant draws a value of its own."""

    key: str
    text: str
    variants: tuple[GearPair, GearPair]
    own: tuple[str, ...] = ()


def _new(teeth: str, module: float, width: float, speed: float, torque: float, **changes: Any) -> GearPair:
    return spurcheck.new_pair(
        teeth, module=module, face_width=width, speed=speed, torque=torque, changes=changes
    )


def _relieved(amount: float) -> dict[str, Any]:
    """Tip relief of both gears of 19/41, of which the drawing allows 2 um more or less."""
    starts = {"pinion": 31.0, "gear": 26.0}
    relief = {f"{g}.tip_relief": {"amount": amount, "start_roll_angle": a} for g, a in starts.items()}
    return relief | {"uncertainty": {f"{gear}.tip_relief.amount": "+- 2 um" for gear in starts}}


_BEARINGS = tuple(f"bearings.{g}.{line}_stiffness" for g in ("pinion", "gear") for line in ("loa", "oloa"))


def cases() -> tuple[Case, ...]:
    """Pairs of variants that are unlike each other."""
    relieved = _new("19/41", 2.5, 20.0, 1450.0, 80.0)
    equal = _new("28/28", 3.175, 6.35, 4875.0, 56.5)
    high = {
        "pinion.tip_relief": {"amount": 10.0, "start_roll_angle": 24.0},
        "gear.tip_relief": {"amount": 10.0, "start_roll_angle": 24.0},
        "uncertainty": {"pinion.tip_relief.amount": "+- 2 um", "gear.tip_relief.amount": "+- 2 um"},
    }
    factors = {"uncertainty": dict.fromkeys(_BEARINGS, "/ 2 .. * 2")}
    stiff = _new("43/17", 2.0, 24.0, 2600.0, 95.0).with_(factors)
    oil = _new("16/55", 1.5, 15.0, 900.0, 12.0, oil="vg100", temperature=60.0)
    oil = oil.with_({"uncertainty": {"lubricant.viscosity_law.temperature": "+- 10 K"}})
    damped = unlike_pair("contact_ratio_2_3_on_shafts").with_(
        {
            "mesh.damping_ratio": 0.03,
            "uncertainty": {
                "mesh.damping_ratio": "+- 30 %",
                "mesh.stiffness_factor": "+- 8 %",
                "operating.pinion_torque": "+- 4 %",
            },
        }
    )
    wide = _new("31/57", 3.0, 25.0, 12_000.0, 150.0)
    return (
        Case(
            "relief",
            "19/41, relief 8 or 14 um",
            (relieved.with_(_relieved(8.0)), relieved.with_(_relieved(14.0))),
            ("pinion.tip_relief.amount", "gear.tip_relief.amount"),
        ),
        Case("relieved", "28/28, no relief or 10 um", (equal, equal.with_(high))),
        Case(
            "teeth",
            "23/81 or 25/79, one centre distance",
            (_new("23/81", 2.0, 20.0, 3000.0, 60.0), _new("25/79", 2.0, 20.0, 3000.0, 60.0)),
        ),
        Case("width", "31/57 at 12 000 rpm, 25 or 26 mm wide", (wide, wide.with_(face_width=26.0))),
        Case(
            "bearings",
            "43/17, bearings of 1e8 or 3e8 N/m",
            (
                stiff.with_({"bearings.stiffness": 1e8}),
                stiff.with_({"bearings.stiffness": 3e8}),
            ),
            _BEARINGS,
        ),
        Case("oil", "16/55, oil VG 100 or VG 220", (oil, oil.with_(oil="vg220"))),
        Case(
            "damping",
            "on shafts, damping ratio of the mesh 0.03 or 0.04",
            (damped, damped.with_({"mesh.damping_ratio": 0.04})),
        ),
    )


def plain(case: Case, samples: int, seed: int) -> tuple[dict[str, float], int]:
    """Share of the samples in which the second variant is better, by result, and the refused samples."""
    rng = np.random.default_rng(seed)
    inputs = [uncertain_inputs(pair) for pair in case.variants]
    fields = sorted({one.field for of in inputs for one in of})
    won = dict.fromkeys(RESULTS, 0)
    count = 0
    refused = 0
    for _ in range(samples):
        common = dict(zip(fields, rng.random(len(fields)), strict=True))
        numbers = []
        for pair, of in zip(case.variants, inputs, strict=True):
            drawn = common | {field: rng.random() for field in case.own}
            try:
                numbers.append(
                    spurcheck.predict(varied(pair, [(one, drawn[one.field]) for one in of])).numbers
                )
            except SpurcheckError:
                break
        if len(numbers) < 2:
            refused += 1
            continue
        count += 1
        first, second = numbers
        for name, larger in RESULTS.items():
            won[name] += second[name] > first[name] if larger else second[name] < first[name]
    return {name: number / count for name, number in won.items()}, refused


def better(found: xr.Dataset, name: str, machines: int | None = None) -> float:
    """Share of the first machines in which B is better than A, counted again from the samples."""
    a, b = found[name].to_numpy()[:, :machines]
    return float(np.mean(b > a if RESULTS[name] else b < a))


def row(case: Case) -> dict[str, Any]:
    """Shares of one case, by both programs."""
    comparison = spurcheck.compare(*case.variants, samples=SAMPLES)
    shares, refused = plain(case, PLAIN, SEED)
    rows = {
        name: {
            "given": comparison[f"{name}_given"].to_numpy().tolist(),
            "compare": float(comparison["better"].sel(result=name, variant="B", other="A")),
            "first": better(comparison, name, FEW),
            "plain": shares[name],
        }
        for name in RESULTS
    }
    return {"key": case.key, "text": case.text, "inputs": comparison.sizes["input"], "refused": refused} | {
        "contact_lost": comparison["contact_lost"].to_numpy().tolist(),
        "results": rows,
    }


def main(arguments: list[str] | None = None) -> int:
    """Compute all cases or the named cases and print both shares. Returns 1 if the shares differ too much."""
    parser = argparse.ArgumentParser(prog="python -m tests.evidence.rankings", description=__doc__)
    parser.add_argument("keys", nargs="*", metavar="CASE", help="cases to compute; default all")
    parser.add_argument("-o", "--output", type=Path, help="rows as .json; those of other cases stay")
    options = parser.parse_args(arguments)
    rows = {}
    if options.output is not None and options.output.exists():
        rows = {one["key"]: one for one in json.loads(options.output.read_text("utf-8"))["cases"]}
    wrong = 0
    warnings.simplefilter("ignore")
    for case in cases():
        if options.keys and case.key not in options.keys:
            continue
        rows[case.key] = entry = row(case)
        for name, shares in entry["results"].items():
            points = 100.0 * abs(shares["compare"] - shares["plain"])
            wrong += points > LIMIT
            words = "".join(f"{key} {100.0 * shares[key]:5.1f}  " for key in ("compare", "first", "plain"))
            print(f"{case.key:10} {name:18} {words} {points:4.1f}", flush=True)
        if options.output is not None:
            computed_cases = [rows[one.key] for one in cases() if one.key in rows]
            stored = {"samples": SAMPLES, "few": FEW, "plain": PLAIN, "limit": LIMIT, "cases": computed_cases}
            options.output.write_text(json.dumps(stored, indent=1) + "\n", encoding="utf-8")
    print(f"{wrong} shares differ by more than {LIMIT:g} points")
    return int(wrong > 0)


if __name__ == "__main__":
    sys.exit(main())

"""Forms of contact of the lumped model beside the exact contact, and where its power goes.

    python -m benchmarks.bench_contact_forms [forms] [speeds] [losses] [beyond]

Tables of docs/theory/contact_energy.md, and of docs/theory/validity.md (beyond contact loss).
"""

from __future__ import annotations

import sys
import warnings
from collections.abc import Sequence

import numpy as np
import xarray as xr

import lumped
from benchmarks.bench_agreement import ENERGY, PAIRS, PRESETS, SAMPLES, exact_motion, line
from lumped.model.periodic_system import periodic_system
from lumped.model.powers import mean_powers
from lumped.model.steady import periodic_solution
from validation.cross_check.comparison import crosscheck
from validation.cross_check.motions import unilateral_orbit
from validation.prediction.motion import predicted


def off(motion: xr.Dataset, exact: xr.Dataset, name: str = "dte") -> float:
    """Largest difference from the exact motion over the peak to peak of the compared one [%]."""
    values = motion[name].to_numpy()
    return float(100.0 * np.abs(values - exact[name].to_numpy()).max() / np.ptp(values))


def forms() -> None:
    """Exact peak to peak in um; four forms of the transmission error, and y of the last, off by per cent."""
    line(
        "preset", "exact", "prescribed", "loaded, linear", "unilateral, static", "unilateral, momentary", "y"
    )
    for name in PRESETS:
        pair = PAIRS[name]
        exact = exact_motion(PAIRS[name])
        fixed = lumped.steady_state(pair.with_(mesh__contact="prescribed"), samples_per_cycle=SAMPLES)
        linear = lumped.steady_state(pair, samples_per_cycle=SAMPLES)
        best = predicted(pair).cycle
        orbit, _ = unilateral_orbit(pair)
        static = linear if orbit is None else orbit.sampled(SAMPLES)
        swing = 1e6 * float(np.ptp(exact["dte"].to_numpy()))
        line(
            name, swing, *(off(one, exact) for one in (fixed, linear, static, best)), off(best, exact, "y_p")
        )


def speeds() -> None:
    """Transmission error of 28/28, energy stiffness, off the exact one over its own peak to peak."""
    rpm = (500, 2000, 4875, 8000, 12000)
    line("relief, contact", *rpm)
    for relief in ("ignored", "static"):
        pairs = [ENERGY.with_(mesh__relief=relief, operating__pinion_speed=one) for one in rpm]
        exact = [exact_motion(pair) for pair in pairs]
        for form in ("prescribed", "loaded"):
            of_form = [
                lumped.steady_state(p.with_(mesh__contact=form), samples_per_cycle=SAMPLES) for p in pairs
            ]
            shares = [f"{0.01 * off(*both):.3f}" for both in zip(of_form, exact, strict=True)]
            line(f"{relief}, {form}", *shares)


def losses() -> None:
    """Per cent of the input of 28/28 without relief, prescribed contact."""
    rpm = (500, 2000, 4875, 8000, 18000)
    line("", *rpm)
    plain = PAIRS["28/28"].with_(mesh__contact="prescribed", mesh__relief="ignored")
    systems = [periodic_system(plain.with_(operating__pinion_speed=one), "full") for one in rpm]
    powers = [mean_powers(periodic_solution(one, np.zeros(1), estimate_error=False)) for one in systems]
    for name in ("sliding", "tooth_dampers", "bearings", "energy_residual"):
        line(name, *(f"{100.0 * getattr(one, name) / one.driving:.3f}" for one in powers))
    at_8000_rpm = powers[3]
    print(f"at 8000 rpm {at_8000_rpm.energy_residual:.0f} W of {1e-3 * at_8000_rpm.driving:.1f} kW")


def beyond() -> None:
    """28/28 beyond contact loss: same equations; exact transmission error and y, by the cross-check [%]."""
    fixed = PAIRS["28/28"].with_(mesh__contact="prescribed")
    plain = {"mesh.relief": "ignored", "operating.pinion_speed": 8000}
    loaded = {"mesh.relief": "ignored", "mesh.damping_ratio": 0.03, "operating.pinion_torque": 100}
    cases = {
        "prescribed, without relief, 8000 rpm": fixed.with_(plain),
        "loaded, energy, 100 N m, 17000 rpm": ENERGY.with_(loaded | {"operating.pinion_speed": 17000}),
        "prescribed, with relief, 4875 rpm": fixed.with_(operating__pinion_speed=4875),
    }
    line("pair", "same equations", "dte", "y_p")
    for name, pair in cases.items():
        check = crosscheck(pair, cycles=6, variant=False)
        differences = {one.quantity: f"{100.0 * one.difference:.2g}" for one in check.of("exact")}
        line(name, f"{check.worst('linear').difference:.0e}", differences["dte"], differences["y_p"])


def main(names: Sequence[str]) -> None:
    """Print the tables of these names, or all."""
    warnings.simplefilter("ignore")
    for table in (forms, speeds, losses, beyond):
        if not names or table.__name__ in names:
            print(f"\n{table.__doc__}\n")
            table()


if __name__ == "__main__":
    main(sys.argv[1:])

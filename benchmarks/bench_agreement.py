"""Lumped prediction and exact contact: how far apart are they, and by what?

    python -m benchmarks.bench_agreement [sizes] [effects] [presets] [scales]

Tables of docs/verification/agreement.md ("Prediction and exact contact") and docs/theory/multibody.md
("Effects", "The verdict").
"""

from __future__ import annotations

import sys
import warnings
from collections.abc import Sequence

import numpy as np
import xarray as xr

import multibody
from lumped import GearPair, load_gear_pair
from lumped.errors import NumericalError
from multibody.run.effects import EFFECTS
from validation.cross_check.comparison import crosscheck
from validation.cross_check.motions import CONTACT_LOSS, unilateral_orbit
from validation.exchange.new_pair_file import new_pair
from validation.prediction.motion import predicted

PRESETS = {
    "FZG-C": "fzg_c", "29/47": "high_contact_ratio_29_47", "50/50": "kahraman_blankenship_50_50",
    "28/28": "nasa_28_28", "25/31": "nasa_art_25_31",
}  # fmt: skip
OWN = {
    "31/57": (3.0, 25.0, 12_000.0, 150.0),
    "37/71": (2.0, 18.0, 1450.0, 60.0),
    "19/41": (2.5, 20.0, 1450.0, 80.0),
}
PAIRS = {name: load_gear_pair(preset) for name, preset in PRESETS.items()}
PAIRS |= {teeth: new_pair(teeth, *drawing) for teeth, drawing in OWN.items()}
ENERGY = PAIRS["28/28"].with_(mesh__stiffness={"model": "energy"})
SAMPLES = 512


def line(*cells: object) -> None:
    """A line of a table."""
    texts = (f"{one:.2f}" if isinstance(one, float) else str(one) for one in cells)
    print(f"| {' | '.join(texts)} |", flush=True)


def smaller(pair: GearPair, share: float) -> GearPair:
    """Every length of the flanks times a share; without finite motions nothing else would change."""
    sizes = {"operating.pinion_torque": pair.operating.pinion_torque}
    sizes |= {"mesh.backlash": 1e3 * pair.mesh.backlash}
    for name in ("pinion", "gear"):
        if (relief := getattr(pair, name).tip_relief) is not None:
            sizes |= {f"{name}.tip_relief.amount": 1e6 * relief.amount}
    return pair.with_({field: share * size for field, size in sizes.items()})


def damped(pair: GearPair, share: float) -> GearPair:
    return pair.with_(mesh__damping_ratio=share * pair.mesh.damping_ratio)


def exact_motion(pair: GearPair, without: str = "") -> xr.Dataset:
    """The exact model's own periodic motion, as the cross-check starts it; without one effect."""
    orbit, _ = unilateral_orbit(pair)
    effects = {} if orbit is None else dict(CONTACT_LOSS["exact"])
    effects |= {without: False} if without else {}
    start = None if orbit is None else orbit.states[0]
    return multibody.steady_state(pair, samples_per_cycle=SAMPLES, initial=start, effects=effects)


def apart(pair: GearPair, without: str = "") -> float:
    """Peak to peak of the transmission error, exact less prediction, over the prediction's [%]."""
    try:
        exact = np.ptp(exact_motion(pair, without)["dte"].to_numpy())
    except NumericalError:
        return np.nan
    return float(100.0 * (exact / np.ptp(predicted(pair).transmission_error.to_numpy()) - 1.0))


def sizes() -> None:
    """Exact less prediction in per cent: as given, with smaller lengths or damping, without a moving line."""
    line("pair", "as given", "lengths x 1/4", "damping x 1/2", "line does not move", "damping x 1/4")
    for name, pair in PAIRS.items():
        cases = pair, smaller(pair, 0.25), damped(pair, 0.5)
        line(name, *map(apart, cases), apart(pair, "moving_line"), apart(damped(pair, 0.25)))


def effects() -> None:
    """The same as given, and how much it changes without each effect of the exact model."""
    line("pair", "as given", *EFFECTS)
    for name, pair in PAIRS.items():
        as_given = apart(pair)
        line(name, as_given, *(apart(pair, effect) - as_given for effect in EFFECTS))


def presets() -> None:
    """Differences of the exact model by the measure of the cross-check, relief ignored, in per cent."""
    shown = ("dte", "x_p", "x_g", "y_p", "y_g", "normal_load")
    line("preset", *shown)
    for name in PRESETS:
        pair = PAIRS[name].with_(mesh__relief="ignored")
        check = crosscheck(pair, cycles=6, fidelities=("exact",))
        differences = {one.quantity: 100.0 * one.difference for one in check.of("exact")}
        line(name, *(differences[quantity] for quantity in shown))
    pair = ENERGY.with_(mesh__relief="ignored", friction__law="coulomb")
    causes = multibody.attribution(pair)["alone"].sel(quantity="dte")
    print("28/28, energy, law I, share of each cause:", causes.to_series().to_dict())


def scales() -> None:
    """Swing of a quantity, largest difference and that of the means over it, in per cent; relief ignored."""
    slow = {"operating.pinion_speed": 300.0, "friction.law": "none"}
    cases = {"19/41, 300 rpm, no friction": PAIRS["19/41"].with_(slow)}
    line("pair", "quantity", "swing, um or N", "difference", "of the means")
    for name, pair in (cases | {teeth: PAIRS[teeth] for teeth in ("19/41", "31/57")}).items():
        prediction = predicted(pair).cycle
        exact = exact_motion(pair)
        for one in ("dte", "x_g", "bearing_force_y_g", "friction_force"):
            mine, other = (
                (run[one].sum("pair") if "pair" in run[one].dims else run[one]).to_numpy()
                for run in (prediction, exact)
            )
            if (swing := float(np.ptp(mine))) == 0.0:
                continue
            scale = 1.0 if "force" in one else 1e6
            ratios = float(np.abs(mine - other).max()) / swing, abs(float((mine - other).mean())) / swing
            line(name, one, scale * swing, *(100.0 * ratio for ratio in ratios))


def main(names: Sequence[str]) -> None:
    """Print the tables of these names, or all."""
    warnings.simplefilter("ignore")
    for table in (sizes, effects, presets, scales):
        if not names or table.__name__ in names:
            print(f"\n{table.__doc__}\n")
            table()


if __name__ == "__main__":
    main(sys.argv[1:])

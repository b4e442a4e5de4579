"""Random sound pairs of the kinds of the presets: none of them may get "fails".

Sound means that the lumped model holds by its own numbers: a stable motion in which teeth in contact touch
and never pull.
"""

import json
import random
import time
import warnings
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from lumped import GearPair, LawRangeWarning, load_gear_pair, preset_names
from lumped.errors import NumericalError, ParameterError
from lumped.friction.registry import LAWS
from validation.cross_check.comparison import crosscheck
from validation.cross_check.variant import prediction_holds

_STIFFNESS = (
    {"model": "rectangular"}, {"model": "parabolic"}, {"model": "parabolic", "ramp_length": 0.5},
    {"model": "energy"}, {"model": "energy", "hertz": "linear"},
)  # fmt: skip


def drawn(count: int, seed: str, *, relief: bool = False, loaded: bool = False) -> Iterator[GearPair]:
    """Random variations of the presets that exist: gears, bearings, teeth, law, relief, speed and load."""
    rng = random.Random(seed)
    names = sorted(preset_names())
    found = 0
    if relief:
        names = [name for name in names if load_gear_pair(name).pinion.tip_relief is not None]
    while found < count:
        try:
            pair = _varied(load_gear_pair(names[found % len(names)]), rng)
            pair = pair.with_({"mesh.contact": "loaded" if loaded else "prescribed"})
            if (relief and pair.mesh.relief != "static") or not _holds(pair):
                continue
        except (ParameterError, NumericalError):
            continue
        found += 1
        yield pair


def _holds(pair: GearPair) -> bool:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", LawRangeWarning)
        return prediction_holds(pair)


def _varied(base: GearPair, rng: random.Random) -> GearPair:
    relief = "ignored"
    fields: dict[str, Any] = {
        "mesh.stiffness": rng.choice(_STIFFNESS),
        "mesh.damping_ratio": rng.uniform(0.02, 0.12),
        "friction.law": rng.choice(list(LAWS)),
        "lubricant.viscosity": rng.uniform(5.0, 40.0),
        "operating.pinion_speed": base.operating.pinion_speed * 9.5493 * rng.uniform(0.4, 1.8),
        "operating.pinion_torque": base.operating.pinion_torque * rng.uniform(0.3, 1.5),
    }
    for gear in ("pinion", "gear"):
        for direction in ("loa", "oloa"):
            fields[f"bearings.{gear}.{direction}_stiffness"] = 1e8 * 10.0 ** rng.uniform(-0.3, 1.0)
            fields[f"bearings.{gear}.{direction}_damping_ratio"] = rng.uniform(0.02, 0.1)
    if rng.random() < 0.5:  # gears of other sizes, meshing without backlash but for the thinning
        shifts = {f"{gear}.profile_shift": rng.uniform(0.0, 0.3) for gear in ("pinion", "gear")}
        teeth = {f"{gear}.teeth": rng.randint(20, 60) for gear in ("pinion", "gear")}
        lengths = {f"{g}.{what}": None for g in ("pinion", "gear") for what in ("tip_diameter", "addendum")}
        reliefs = {f"{gear}.tip_relief": None for gear in ("pinion", "gear")}
        fields |= {**shifts, **teeth, **lengths, **reliefs, "centre_distance": None}
    elif base.pinion.tip_relief is not None and rng.random() < 0.6:
        relief = "static"
    fields["mesh.relief"] = relief
    return base.with_(fields)


def sound_pairs(
    count: int, seed: str, output: Path | None = None, *, relief: bool = False, loaded: bool = False
) -> int:
    """Cross-check random sound pairs and print every one that fails; 1 where there is any."""
    rows: list[dict[str, Any]] = []
    for number, pair in enumerate(drawn(count, seed, relief=relief, loaded=loaded)):
        rows.append(_row(pair, f"{'relief ' * relief}{'loaded ' * loaded}{seed}/{number}"))
        if rows[-1]["verdict"] in ("fails", "not computed"):
            print(rows[-1], flush=True)
    verdicts = Counter(row["verdict"] for row in rows)
    seconds = sum(row["seconds"] for row in rows) / max(len(rows), 1)
    print(", ".join(f"{n} {name}" for name, n in sorted(verdicts.items())) + f"; {seconds:.2g} s per pair")
    if output is not None:
        earlier = json.loads(output.read_text(encoding="utf-8")) if output.exists() else []
        named = {row["name"]: row for row in [*earlier, *rows]}
        output.write_text(json.dumps(list(named.values()), indent=1) + "\n", encoding="utf-8")
    return int(verdicts["fails"] > 0)


def _row(pair: GearPair, name: str) -> dict[str, Any]:
    started = time.perf_counter()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", LawRangeWarning)
        try:
            check = crosscheck(pair, cycles=8, samples_per_cycle=128, supports="springs")
        except (NumericalError, ParameterError) as error:
            return {
                "name": name,
                "verdict": "not computed",
                "text": str(error)[:200],
                "seconds": time.perf_counter() - started,
            }
    worst = max(check.judgements, key=lambda one: one.value / one.limit if one.limit > 0.0 else 0.0)
    return {
        "name": name, "preset": pair.name, "verdict": check.verdict.word,
        "failures": [f"{f.check}: {f.value:.3g} > {f.limit:.3g}" for f in check.failures],
        "check": worst.check, "use": worst.value / worst.limit if worst.limit > 0.0 else 0.0,
        "law": pair.friction.law, "stiffness": pair.mesh.stiffness.model, "relief": pair.mesh.relief,
        "seconds": time.perf_counter() - started,
    }  # fmt: skip

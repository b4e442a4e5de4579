"""How often ranges of ``spurcheck.calibrate`` hold the truth, and whether its next test keeps its promise.

``python -m tests.evidence.calibration`` judges rigs of five kinds, then the next test; ``--kinds promise``
judges the next test alone.

A truth is a machine drawn from the ranges of a pair, of one of five kinds: of the same model, with another
stiffness model, with prescribed contact, with the motion of the multibody model, or with teeth of its own.
Two runs with noise record its transmission error. The ranges of page 1 at a third speed, 5 to 95 %, hold the
truth or not, with the discrepancy of the model and without.

A promise is kept where the recommended test, run on the rig of the same model, leaves as much of the width of
page 1 as the calibration before it said.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

import multibody
import spurcheck
from lumped import GearPair
from lumped.errors import SpurcheckError
from validation.calibrate import calibrate
from validation.calibrate.forms import machine, numeric_inputs
from validation.calibrate.next_test import page_one_deviations
from validation.check.curves import Channel, Curves
from validation.check.motion_curves import MotionCurves
from validation.prediction.motion import Motion, Prediction, measured, predicted

KINDS = {
    "same": "the same model",
    "stiffness": "other stiffness model",
    "contact": "prescribed contact",
    "multibody": "record of the multibody model",
    "teeth": "teeth of its own (class 6)",
}
#: Kinds of runs that judge the next test, and whether the model may be off.
PROMISES = {"promise": True, "promise-exact": False}
#: Results of page 1 that are judged.
RESULTS = ("dte_peak_to_peak", "dynamic_factor", "tooth_load", "bearing_rms")
#: Speeds of the two runs and of page 1 [rpm]; noise over the peak to peak; samples in a mesh cycle; cycles.
SPEEDS, OPERATING, NOISE, PER_CYCLE, CYCLES = (1450.0, 2900.0), 2200.0, 0.02, 64, 60
RANGES = {
    "mesh.stiffness_factor": "+- 8 %",
    "mesh.damping_ratio": "/ 2.5 .. * 2.5",
    "bearings.pinion.loa_stiffness": "/ 2 .. * 2",
    "bearings.gear.loa_stiffness": "/ 2 .. * 2",
    "pinion.tip_relief.amount": "+- 2 um",
    "friction.coefficient": "+- 30 %",
}


def calibrated_pair() -> GearPair:
    """The pair that is calibrated: 19/41 with six uncertain inputs; its form of contact is assumed."""
    pair = spurcheck.new_pair(
        "19/41", module=2.5, face_width=20, speed=OPERATING, torque=80, stiffness="energy"
    )
    known: dict[str, Any] = {f"{gear}.tip_alteration": 0.0 for gear in ("pinion", "gear")}
    known |= {"friction": {"law": "coulomb", "coefficient": 0.05}, "bearings.stiffness": 2e8}
    known |= {"pinion.tip_relief": {"amount": 10.0, "start_roll_angle": 30.0}}
    return pair.with_(known).with_({"assumed": {"mesh.contact": "loaded"}, "uncertainty": RANGES})


def truth_of(kind: str, number: int) -> tuple[GearPair, GearPair]:
    """A machine of a kind, and its twin with like teeth; ``number`` draws it."""
    pair = calibrated_pair()
    changes: dict[str, Any] = {}
    if kind == "stiffness":
        changes = {"mesh.stiffness": {"model": "finite_elements" if number % 2 else "parabolic"}}
    elif kind == "contact":
        changes = {"mesh.contact": "prescribed"}
    inputs = numeric_inputs(pair)
    z = np.random.default_rng([number, len(inputs)]).standard_normal(len(inputs))
    drawn = machine(pair.with_(changes) if changes else pair, inputs, z)
    if kind == "teeth":
        errors = {"tolerance_class": 6, "seed": number + 1}
        return drawn.with_({"pinion.deviations": errors, "gear.deviations": errors}), drawn
    return drawn, drawn


def motion_of(truth: GearPair, kind: str, rpm: float, torque: float | None = None) -> Prediction:
    """The motion of the truth at a speed, and at a torque [N m]."""
    load = {} if torque is None else {"operating.pinion_torque": torque}
    at = truth.with_({"operating.pinion_speed": rpm} | load)
    if kind == "multibody":
        return measured(at, multibody.steady_state(at, samples_per_cycle=256, rtol=1e-7), Motion.SECOND)
    return predicted(at)


def record_of(
    truth: GearPair,
    kind: str,
    rpm: float,
    seed: int,
    quantities: Sequence[str] = ("dte",),
    torque: float | None = None,
) -> Curves:
    """A run that records quantities with white noise, the transmission error where none are named."""
    motion = motion_of(truth, kind, rpm, torque)
    curves = MotionCurves.of(motion.pair, motion.cycle, motion.mesh_cycles, truth.pinion.teeth)
    u = np.arange(max(CYCLES, motion.mesh_cycles) * PER_CYCLE) / PER_CYCLE
    random = np.random.default_rng([seed, int(rpm)])
    channels = []
    for quantity in quantities:
        values = curves.at(quantity, u + 0.37)
        noise = NOISE * np.ptp(values) * random.standard_normal(u.size)
        channels.append(Channel(quantity, quantity, values + noise))
    operating = motion.pair.operating
    return Curves(
        f"run at {rpm:g} rpm and {operating.pinion_torque:g} N m", "time",
        u * motion.pair.geometry.mesh_period, tuple(channels), role="measurement",
        pinion_speed=operating.pinion_speed, pinion_torque=operating.pinion_torque,
    )  # fmt: skip


def judged(kind: str, number: int) -> dict[str, Any]:
    """Whether the ranges of one machine hold its truth, with the discrepancy and without."""
    truth, twin = truth_of(kind, number)
    records = [record_of(truth, kind, rpm, number) for rpm in SPEEDS]
    true = motion_of(twin, kind, OPERATING).numbers
    row: dict[str, Any] = {"kind": kind, "number": number, "truth": {name: true[name] for name in RESULTS}}
    for name, discrepancy in (("with", True), ("without", False)):
        begun = time.process_time()
        try:
            posterior = calibrate(calibrated_pair(), records, discrepancy, machines=64, progress=False)
        except SpurcheckError as error:
            row[name] = {"refused": str(error)[:300]}
            continue
        ranges = {one: posterior.results[f"{one}_percentile"].to_numpy().tolist() for one in RESULTS}
        row[name] = {
            "holds": {one: ends[0] <= true[one] <= ends[-1] for one, ends in ranges.items()},
            "ranges": ranges,
            "level": posterior.level,
            "pareto_shape": posterior.pareto_shape,
            "seconds": time.process_time() - begun,
        }
    return row


def promised(kind: str, number: int) -> dict[str, Any]:
    """What the next test of one machine promises to leave, and what it leaves when it is run."""
    truth, _ = truth_of("same", number)
    records = [record_of(truth, "same", rpm, number) for rpm in SPEEDS]
    before = calibrate(calibrated_pair(), records, PROMISES[kind], progress=False)
    test = next(one for one in before.next_tests if len(one.speeds_rpm) == 1)
    run = record_of(truth, "same", test.speeds_rpm[0], 1000 + number, test.channels, test.torque)
    after = calibrate(calibrated_pair(), [*records, run], PROMISES[kind], progress=False)
    deviations = [page_one_deviations(one) for one in (before, after)]
    ranges = [
        [np.ptp(one.results[f"{name}_percentile"].to_numpy()) for name in test.left]
        for one in (before, after)
    ]
    return {
        "kind": kind,
        "number": number,
        "test": test.words.partition(" leaves")[0],
        "promised": test.left,
        "left": dict(zip(test.left, (deviations[1] / deviations[0]).tolist(), strict=True)),
        "left_of_range": dict(zip(test.left, np.divide(ranges[1], ranges[0]).tolist(), strict=True)),
    }


def main() -> int:
    """Judge machines until the processor time is over, and add them to those that are stored."""
    parser = argparse.ArgumentParser(prog="python -m tests.evidence.calibration", description=__doc__)
    parser.add_argument("-o", "--output", type=Path, default=Path("docs/verification/calibration.json"))
    parser.add_argument("--machines", type=int, default=10, help="machines of each kind")
    parser.add_argument("--kinds", nargs="+", choices=(*KINDS, *PROMISES), default=[*KINDS, *PROMISES])
    arguments = parser.parse_args()
    stored: dict[str, Any] = {"noise": NOISE, "promises": [], "machines": []}
    if arguments.output.is_file():
        stored |= json.loads(arguments.output.read_text(encoding="utf-8"))
    done = {(row["kind"], row["number"]) for row in [*stored["machines"], *stored["promises"]]}
    for number in range(arguments.machines):
        for kind in arguments.kinds:
            if (kind, number) in done:
                continue
            rows = stored["promises" if kind in PROMISES else "machines"]
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                try:
                    rows.append((promised if kind in PROMISES else judged)(kind, number))
                except SpurcheckError as error:  # a truth without a motion is no machine
                    rows.append({"kind": kind, "number": number, "left_out": str(error)[:300]})
            arguments.output.write_text(json.dumps(stored, indent=1) + "\n", encoding="utf-8")
            print(kind, number, rows[-1].get("with", rows[-1]).get("holds", rows[-1]), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())

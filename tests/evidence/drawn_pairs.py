"""Drawn pairs: each must have a prediction or a stated reason. ``python -m tests.evidence.drawn_pairs``.

A user asks as for ``spurcheck init``: teeth, module, face width, speed, torque, half of the time profile
shifts. One pair of eight has bearings in the wrong unit, one of six another friction law, one of six little
damping. The draw is wide on purpose: modules of watches and of mills, loads from idling to far beyond what
teeth carry, speeds from 5 to 20,000 rpm. So some pairs cannot exist, and they must be refused with the field.

Plane finite elements, which ``init`` assumes, take 2 s for a new tooth form. One pair of fifty has them, and
the others have a model that takes milliseconds. The 58/58 pair that once had no motion comes first.

Sources: docs/verification/answers.md.
"""

from __future__ import annotations

import argparse
import json
import math
import sys
import time
import warnings
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from lumped.errors import NumericalError, ParameterError
from lumped.schema.pair import GearPair
from validation.exchange.new_pair_file import new_pair
from validation.prediction.motion import Motion, Prediction, predict
from validation.reporting.effort import QUICK
from validation.reporting.page_without_motion import page_without_motion
from validation.reporting.results import Results

TARGET = Path(__file__).parents[2] / "docs" / "verification" / "answers.json"
PAIRS = 1000
SEED = 2026
#: Kinds of answers.
KINDS = ("prediction", "linear motion", "at rest", "refused", "exception")
#: A dynamic factor below 1 by less than this is rounding: where nothing vibrates the factor is 1.
_ROUNDING = 1e-9
#: Least rows of page 1 of a pair without a motion: force, stiffness and one more.
_LEAST_ROWS = 3


@dataclass(frozen=True)
class Request:
    """What a user asks for.

    Attributes
    ----------
    teeth : of pinion and gear
    module, face_width : [mm]
    speed : of the pinion [rpm]
    torque : on the pinion [N m]
    changes : further parameters, path of the field -> value
    """

    teeth: tuple[int, int]
    module: float
    face_width: float
    speed: float
    torque: float
    changes: dict[str, Any]

    @property
    def text(self) -> str:
        """The request as options of ``spurcheck init``."""
        changes = "".join(f" --set {path}={value}" for path, value in self.changes.items())
        return (
            f"--teeth {self.teeth[0]}/{self.teeth[1]} --module {self.module:g} --face-width "
            f"{self.face_width:g} --speed {self.speed:g} --torque {self.torque:g}{changes}"
        )


@dataclass(frozen=True)
class Answer:
    """What came of a request.

    Attributes
    ----------
    kind : one of ``KINDS``
    text : the motion, the refused field, the reason or headline of page 1, or the exception
    request : the request as options
    seconds : processor time
    """

    kind: str
    text: str
    request: str
    seconds: float


def requests(count: int = PAIRS, seed: int = SEED) -> Iterator[Request]:
    """The drawn requests; each depends on the seed and on its number alone."""
    yield Request((58, 58), 2.3, 13.5, 910, 120, {})
    for number in range(1, count):
        rng = np.random.default_rng((seed, number))
        pinion = int(rng.integers(9, 70))
        gear = round(pinion * math.exp(rng.uniform(-0.5, 1.6)))
        module = _rounded(math.exp(rng.uniform(math.log(0.3), math.log(16.0))))
        width = _rounded(module * rng.uniform(4.0, 16.0))
        speed = _rounded(math.exp(rng.uniform(math.log(5.0), math.log(20_000.0))))
        load = math.exp(rng.uniform(math.log(2.0), math.log(900.0)))  # N/mm
        torque = _rounded(load * width * 0.5 * module * pinion * 1e-3)
        changes: dict[str, Any] = {}
        if number % 50:
            changes["mesh.stiffness.model"] = str(rng.choice(["energy", "parabolic"]))
        if rng.random() < 1.0 / 8.0:
            changes["bearings.stiffness"] = _rounded(10.0 ** rng.uniform(1.0, 15.0))
        if rng.random() < 1.0 / 6.0:
            changes["friction.law"] = str(rng.choice(["coulomb", "xu_kahraman", "none"]))
        if rng.random() < 1.0 / 6.0:
            changes["mesh.damping_ratio"] = _rounded(10.0 ** rng.uniform(-3.0, -1.0))
        if rng.random() < 0.5:
            changes["pinion.profile_shift"] = round(float(rng.uniform(-0.3, 0.7)), 2)
            changes["gear.profile_shift"] = round(float(rng.uniform(-0.5, 0.5)), 2)
        yield Request((pinion, gear), module, width, speed, torque, changes)


def _rounded(value: float) -> float:
    return float(f"{value:.3g}")


def answer(request: Request) -> Answer:
    """Predict the pair of a request, and say what came of it."""
    start = time.process_time()
    kind, text = _outcome(request)
    return Answer(kind, text, request.text, time.process_time() - start)


def _outcome(request: Request) -> tuple[str, str]:
    """Kind and text of an answer."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        pair: GearPair | None = None
        try:
            pair = new_pair(
                request.teeth,
                request.module,
                request.face_width,
                request.speed,
                request.torque,
                request.changes,
            )
            return _judged(predict(pair))
        except ParameterError as error:
            return "refused", error.problems[0].field
        except NumericalError as error:
            assert pair is not None
            return _at_rest(pair, error)
        except Exception as error:  # noqa: BLE001  (every other exception is a fault, which the table shows)
            return "exception", f"{type(error).__name__}: {error}"


def _at_rest(pair: GearPair, error: NumericalError) -> tuple[str, str]:
    """Kind and text of a pair without a motion, by page 1 of its report. The page must have numbers."""
    try:
        page = page_without_motion(Results(pair, QUICK), error)
    except Exception as fault:  # noqa: BLE001  (every exception is a fault, which the table shows)
        return "exception", f"page 1: {type(fault).__name__}: {fault}"
    wrong = [row.key for row in page.numbers if not math.isfinite(row.value)]
    if wrong or len(page.numbers) < _LEAST_ROWS or not page.actions:
        return (
            "exception",
            f"page 1 has {len(page.numbers)} rows, {len(page.actions)} actions, wrong: {wrong}",
        )
    return "at rest", page.headline


def _judged(prediction: Prediction) -> tuple[str, str]:
    """Kind and text of a prediction. Its numbers must be finite, its largest force no less than the mean."""
    wrong = [name for name, value in prediction.numbers.items() if not math.isfinite(value)]
    if wrong:
        return "exception", f"{', '.join(wrong)} is no finite number"
    if prediction.dynamic_factor < 1.0 - _ROUNDING:
        return "exception", f"dynamic factor {prediction.dynamic_factor:.9g} below 1"
    if prediction.motion is Motion.LINEAR:
        return "linear motion", prediction.reason
    return "prediction", f"{prediction.motion.text}, {prediction.mesh_cycles} mesh cycles"


def answers(count: int = PAIRS, seed: int = SEED, processes: int = 1) -> list[Answer]:
    """Answers to the drawn requests, in the order of the draw."""
    drawn = list(requests(count, seed))
    if processes == 1:
        return [answer(one) for one in drawn]
    with ProcessPoolExecutor(processes) as pool:
        return list(pool.map(answer, drawn, chunksize=5))


def stored() -> dict[str, Any]:
    """The stored run: seed, date, and the answers."""
    data: dict[str, Any] = json.loads(TARGET.read_text(encoding="utf-8"))
    return data


def main(arguments: list[str] | None = None) -> int:
    """Print what came of the drawn pairs; 1 where a pair has neither a prediction nor a stated reason."""
    parser = argparse.ArgumentParser(prog="python -m tests.evidence.drawn_pairs", description=main.__doc__)
    parser.add_argument("--pairs", type=int, default=PAIRS)
    parser.add_argument("--seed", type=int, default=SEED)
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("-o", "--output", type=Path, help="store the answers, as in docs/verification")
    options = parser.parse_args(arguments)
    start = time.perf_counter()
    result = answers(options.pairs, options.seed, options.processes)
    for one in result:
        if one.kind not in ("prediction", "refused", "at rest"):
            print(f"{one.kind}: {one.request}\n  {one.text}")
    counts = Counter(one.kind for one in result)
    print(", ".join(f"{number} {kind}" for kind, number in counts.most_common()), end="; ")
    seconds = sum(one.seconds for one in result)
    print(f"{seconds:.0f} s of processor time, {time.perf_counter() - start:.0f} s")
    if options.output is not None:
        rows = [{name: value for name, value in asdict(one).items() if name != "seconds"} for one in result]
        head = {"seed": options.seed, "processor_seconds": round(seconds)}
        options.output.write_text(json.dumps(head | {"answers": rows}, indent=0) + "\n", encoding="utf-8")
    return int(counts["exception"] > 0)


if __name__ == "__main__":
    sys.exit(main())

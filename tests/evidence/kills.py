"""SIGKILL of real reports and sweeps at sampled moments: ``python -m tests.evidence.kills``.

Each run is a process of its own, as a user starts it. It is killed at a moment of its duration, the moments
spread evenly with a random part. What must hold after each kill:

- The folder of a report does not exist, or it is complete: every file that its list names is there.
- A hidden working folder that the killed run leaves is gone after the next run.
- A sweep that is killed and resumed has the bytes of a sweep that was not killed.
- No process of the killed run is left after some seconds.

Sources: docs/verification/kills.md.
"""

from __future__ import annotations

import argparse
import json
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from validation.files.abandoned import PREFIX
from validation.files.folder import CONTENTS

TARGET = Path(__file__).parents[2] / "docs" / "verification" / "kills.json"
KILLS = 20
SEED = 7
#: Moments go beyond the duration of an undisturbed run, because its time varies.
_BEYOND = 1.05
#: Seconds after which every process of a killed run must have ended.
_LAST_PROCESS = 30.0
STUDY = """\
name = "killed"
gear_pair = "nasa_28_28"
analysis = "predict"
outputs = ["efficiency", "dte_peak_to_peak", "dynamic_factor"]

[[axes]]
field = "operating.pinion_speed"
low = 1500
high = 6000
count = 25

[[axes]]
field = "operating.pinion_torque"
low = 20
high = 100
count = 6
"""


@dataclass(frozen=True)
class Kill:
    """One killed run and what it left.

    Attributes
    ----------
    command : "report" or "sweep"
    moment : moment of the kill, over the duration of an undisturbed run
    ended : whether the run had ended before the kill
    left : "nothing", "a complete folder", or what is wrong
    hidden : number of hidden working folders that the run left
    processes : whether a process of the run was still there after ``_LAST_PROCESS`` seconds
    same : whether the next run gave the results of an undisturbed run
    """

    command: str
    moment: float
    ended: bool
    left: str
    hidden: int
    processes: bool
    same: bool

    @property
    def good(self) -> bool:
        """Whether nothing half written, no process and no other result came of the kill."""
        return self.left in ("nothing", "a complete folder", "a store") and not self.processes and self.same


def started(arguments: Sequence[str], folder: Path) -> subprocess.Popen[bytes]:
    """Start the command in a folder, in a group of processes of its own."""
    command = [sys.executable, "-m", "spurcheck", *arguments]
    silent = subprocess.DEVNULL
    return subprocess.Popen(command, cwd=folder, stdout=silent, stderr=silent, start_new_session=True)


def completed(arguments: Sequence[str], folder: Path) -> float:
    """Run the command to its end; returns its duration [s]."""
    start = time.perf_counter()
    code = started(arguments, folder).wait()
    if code:
        raise RuntimeError(f"spurcheck {' '.join(arguments)} ended with {code}")
    return time.perf_counter() - start


def killed(arguments: Sequence[str], folder: Path, seconds: float) -> tuple[bool, bool]:
    """Start the command and kill it after some seconds.

    Returns whether it had ended before, and whether a process of it is left ``_LAST_PROCESS`` seconds later.
    """
    process = started(arguments, folder)
    try:
        process.wait(seconds)
        ended = True
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
        ended = False
    end = time.monotonic() + _LAST_PROCESS
    while time.monotonic() < end:
        try:
            os.killpg(process.pid, 0)
        except ProcessLookupError:
            return ended, False
        time.sleep(0.2)
    with suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
    return ended, True


def hidden_folders(folder: Path) -> int:
    """Number of hidden working folders."""
    return len(list(folder.glob(f"{PREFIX}*")))


def left_of_report(out: Path) -> str:
    """What is in the folder of a report: "nothing", "a complete folder", or what is wrong."""
    if not out.exists():
        return "nothing"
    try:
        names = json.loads((out / CONTENTS).read_text(encoding="utf-8"))["files"]
        json.loads((out / "report.json").read_text(encoding="utf-8"))
    except (OSError, ValueError, KeyError) as error:
        return f"half a folder: {error}"
    missing = [name for name in names if not (out / name).is_file()]
    return f"half a folder: {missing[0]} is missing" if missing else "a complete folder"


def report_data(out: Path) -> dict[str, Any]:
    """report.json without its timestamps."""
    data: dict[str, Any] = json.loads((out / "report.json").read_text(encoding="utf-8"))
    data.pop("timestamps")
    return data


def kills_of_reports(count: int, seed: int, tell: Callable[[Kill], None]) -> None:
    """Kill reports one after the other in one folder; the last run is not killed."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        command = ("report", "nasa_28_28", "--quick", "--force", "-o", "out")
        completed(command, folder)  # compiles what is not stored
        duration = completed(command, folder)
        undisturbed = report_data(folder / "out")
        before = 0
        for moment in moments(count, seed):
            ended, processes = killed(command, folder, moment * duration)
            hidden = hidden_folders(folder)
            left = left_of_report(folder / "out")
            # The earlier report is there, or in the hidden folder of the kill between the two renames.
            removed = hidden <= 1 and before <= 1
            same = left != "a complete folder" or report_data(folder / "out") == undisturbed
            tell(Kill("report", moment, ended, left, hidden, processes, same and removed))
            before = hidden
        completed(command, folder)
        clean = hidden_folders(folder) == 0 and report_data(folder / "out") == undisturbed
        tell(Kill("report", 0.0, True, left_of_report(folder / "out"), 0, False, clean))


def kills_of_sweeps(count: int, seed: int, tell: Callable[[Kill], None]) -> None:
    """Kill sweeps, each in a folder of its own, and resume each."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "study.toml").write_text(STUDY, encoding="utf-8")
        first = ("sweep", "study.toml", "--workers", "2", "-o", "first")
        completed(first, folder)
        duration = completed((*first[:-1], "undisturbed"), folder)
        undisturbed = (folder / "undisturbed" / "results.nc").read_bytes()
        for number, moment in enumerate(moments(count, seed + 1)):
            command = (*first[:-1], f"run{number}")
            ended, processes = killed(command, folder, moment * duration)
            results = folder / f"run{number}" / "results.nc"
            left = "a store" if (folder / f"run{number}").exists() else "nothing"
            if results.exists() and results.read_bytes() != undisturbed:
                left = "half a file of results"
            completed((*command, "--resume"), folder)
            same = results.read_bytes() == undisturbed
            others = [one.name for one in results.parent.iterdir() if one.name.startswith(".")]
            tell(Kill("sweep", moment, ended, left, len(others), processes, same and not others))


def moments(count: int, seed: int) -> list[float]:
    """Moments over the duration: one in each of ``count`` equal parts."""
    parts = np.random.default_rng(seed).random(count)
    return [float(moment) for moment in (np.arange(count) + parts) / count * _BEYOND]


def main(arguments: list[str] | None = None) -> int:
    """Print what each kill left; 1 where something is wrong."""
    parser = argparse.ArgumentParser(prog="python -m tests.evidence.kills", description=main.__doc__)
    parser.add_argument("--kills", type=int, default=KILLS, help="of each of report and sweep")
    parser.add_argument("--seed", type=int, default=SEED)
    parser.add_argument("--command", choices=("report", "sweep"), help="default both")
    parser.add_argument("-o", "--output", type=Path, help="store the kills, as in docs/verification")
    options = parser.parse_args(arguments)
    kills: list[Kill] = []

    def tell(kill: Kill) -> None:
        kills.append(kill)
        print("good" if kill.good else "WRONG", kill, flush=True)

    runs = {"report": kills_of_reports, "sweep": kills_of_sweeps}
    for name in [options.command] if options.command else list(runs):
        runs[name](options.kills, options.seed, tell)
    wrong = sum(not kill.good for kill in kills)
    print(f"{len(kills)} runs, {wrong} wrong")
    if options.output is not None:
        data = {"seed": options.seed, "kills": [asdict(kill) for kill in kills]}
        options.output.write_text(json.dumps(data, indent=0) + "\n", encoding="utf-8")
    return int(wrong > 0)


if __name__ == "__main__":
    sys.exit(main())

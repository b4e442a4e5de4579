"""What the tests say of a mutant: killed, survived, or undecided for want of time.

The tree is copied once. A mutant is written into the copy, the nearest tests run until one fails, and the
file is put back. A test that fails has killed the mutant only if it passes without it; one that takes too
long only if it takes less than a third of the limit without it.
"""

from __future__ import annotations

import compileall
import contextlib
import json
import os
import py_compile
import resource
import shutil
import signal
import subprocess
import sys
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from tests.evidence.mutants.drawing import Mutant
from tests.evidence.mutants.nearest import Nearest

_NOT_COPIED = (
    ".git",
    ".venv",
    "build",
    "dist",
    "report",
    "_generated",
    "gallery",
    "__pycache__",
    ".*_cache",
    "*.egg-info",
)


@dataclass(frozen=True)
class Limits:
    """How long tests may take, in processor time [s] where not said otherwise."""

    total: float = 300.0  # all tests of a mutant; no further one begins after it
    test: float = 120.0  # one test
    wall: float = 2400.0  # by the clock on the wall, for tests that wait for ever
    others: int = 6  # files of tests beyond those of the folder


@dataclass(frozen=True)
class Verdict:
    """What became of a mutant."""

    verdict: str  # killed, survived, undecided
    by: str  # the test that killed it, or why it is undecided
    tests: int  # how many ran
    seconds: float  # of processor time, control runs included


@dataclass(frozen=True)
class _Run:
    """What one process of pytest left."""

    code: int  # negative: ended by this signal
    events: list[tuple[str, object]]
    seconds: float

    def of(self, kind: str) -> list[str]:
        return [str(value) for event, value in self.events if event == kind]

    @cached_property
    def at(self) -> str:
        """The test that was running when the process ended; empty: none."""
        started = self.of("start")
        ended = self.of("end")
        return started[-1] if started and started[-1:] != ended[-1:] else ""

    @cached_property
    def items(self) -> list[str]:
        """Tests collected, in order."""
        return next(
            (value for event, value in self.events if event == "items" and isinstance(value, list)), []
        )


class Court:
    """Judges mutants of a tree in a copy of it."""

    def __init__(self, tree: Path, folder: Path, limits: Limits | None = None) -> None:
        self.limits = limits or Limits()
        self.copy = folder / "tree"
        shutil.copytree(tree, self.copy, ignore=shutil.ignore_patterns(*_NOT_COPIED))
        shutil.copy(Path(__file__).with_name("clock.py"), self.copy / "mutant_clock.py")
        # Compiled modules are known by their content: two mutants of one second and one size differ.
        by_content = py_compile.PycInvalidationMode.CHECKED_HASH
        compileall.compile_dir(self.copy, quiet=2, invalidation_mode=by_content)
        self.nearest = Nearest(self.copy)
        self._sound: dict[str, tuple[bool, float]] = {}

    def judge(self, mutant: Mutant) -> Verdict:
        """Run tests on a mutant until one fails: tests of the folder, then others until the time is up."""
        before = _spent()
        tests_of_folder, others = self.nearest.files(mutant.file)
        verdict = "survived"
        by = ""
        tests = 0
        for files in (tests_of_folder, others[: self.limits.others]):
            remaining = self.limits.total - (_spent() - before)
            if files and verdict == "survived" and remaining > 0.0:
                run = self._run_changed(mutant, files, remaining)
                verdict, by = self._verdict(run, files)
                tests += len(run.of("start"))
                unrun = len(run.items) - len(run.of("start"))
                if verdict == "survived" and files is tests_of_folder and unrun:
                    verdict = "undecided"
                    by = f"{unrun} tests of the folder left out"
        return Verdict(verdict, by, tests, round(_spent() - before, 1))

    def _run_changed(self, mutant: Mutant, tests: list[str], most: float) -> _Run:
        target = self.copy / mutant.file
        sound = target.read_bytes()
        target.write_text(mutant.source, encoding="utf-8")
        try:
            return self._run(tests, most)
        finally:
            target.write_bytes(sound)

    def _verdict(self, run: _Run, tests: list[str]) -> tuple[str, str]:
        """Verdict of one run: survived where every test passes that the time allows."""
        if failed := run.of("failed"):
            if self.sound(failed[0])[0]:
                return "killed", failed[0]
            return "undecided", f"{failed[0]} fails without the change too"
        if run.at:
            return self._ended_inside(run)
        if run.code == 0 or run.of("over"):
            return "survived", ""
        if self._run([*tests, "--collect-only"], self.limits.total).code == 0:
            return "killed", "the tests cannot begin"
        return "undecided", "the tests cannot begin without the change either"

    def _ended_inside(self, run: _Run) -> tuple[str, str]:
        """The process ended inside a test: by a limit, or for itself."""
        passes, seconds = self.sound(run.at)
        if run.code not in (-signal.SIGXCPU, -signal.SIGKILL):
            if passes:
                return "killed", f"{run.at} (the process ends)"
            return "undecided", f"{run.at} ends the process without the change too"
        if passes and seconds < self.limits.test / 3.0:
            return "killed", f"{run.at} (time-out; {seconds:.0f} s without the change)"
        return "undecided", f"time-out in {run.at}, which takes {seconds:.0f} s without the change"

    def sound(self, test: str) -> tuple[bool, float]:
        """Whether a test, or the import of its file, passes without a change; its processor time [s]."""
        if test not in self._sound:
            collect = [] if "::" in test else ["--collect-only"]
            run = self._run([test, *collect], self.limits.total)
            seconds = run.of("seconds")
            self._sound[test] = run.code == 0, float(seconds[0]) if seconds else run.seconds
        return self._sound[test]

    def _run(self, arguments: list[str], most: float) -> _Run:
        """Run pytest in the copy as it is now."""
        record = self.copy.parent / "record.jsonl"
        record.write_text("")
        environment = os.environ | {
            "PYTHONPATH": str(self.copy),
            "NUMBA_CACHE_DIR": str(self.copy.parent / "kernels"),  # wrong kernels do not push out the user's
            "MUTANT_RECORD": str(record),
            "MUTANT_FILES": json.dumps([argument.partition("::")[0] for argument in arguments]),
            "MUTANT_SECONDS": str(most),
            "MUTANT_TEST_SECONDS": str(self.limits.test),
            "MPLBACKEND": "Agg",
        }  # fmt: skip
        options = ["-x", "-p", "mutant_clock", "-p", "no:cacheprovider", "--tb", "no"]
        before = _spent()
        process = subprocess.Popen(
            [sys.executable, "-m", "pytest", *options, *arguments], cwd=self.copy, env=environment,
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True,
        )  # fmt: skip
        try:
            code = process.wait(self.limits.wall)
        except subprocess.TimeoutExpired:
            code = -signal.SIGKILL
        finally:
            _end(process)
        lines = record.read_text(encoding="utf-8").splitlines()
        return _Run(code, [(event, value) for event, value in map(json.loads, lines)], _spent() - before)


def _end(process: subprocess.Popen[bytes]) -> None:
    """End a process and its whole process group. Otherwise workers would outlive the parent process."""
    with contextlib.suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()


def _spent() -> float:
    """Processor time of all ended children [s]."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime

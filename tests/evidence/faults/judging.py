"""What the verdicts say of a program with a fault in it: the parts of ``crosscheck`` and of ``report``."""

import time
import tomllib
import warnings
from collections.abc import Callable, Iterator, Mapping
from contextlib import redirect_stdout
from functools import lru_cache
from io import StringIO

import pytest

from lumped import GearPair, LawRangeWarning, load_gear_pair
from lumped.model.periodic_system import without_shafts
from lumped.typing import FloatArray
from tests.evidence.check import failing
from tests.evidence.faults.fault import Fault
from tests.evidence.faults.outcome import Outcome
from tests.evidence.faults.quantities import change, quantities
from tests.evidence.faults.rewriting import applied
from tests.evidence.kinds import OF_PAIRS
from tests.evidence.pairs import pairs
from tests.evidence.refinement import refinements
from validation.cross_check.comparison import crosscheck
from validation.reporting.effort import QUICK
from validation.reporting.relations import broken_relations
from validation.reporting.results import Results

_CYCLES = 6
_SAMPLES = 64


def judge(fault: Fault, *, thorough: bool = True) -> Outcome:
    """Insert a fault, run every part of the checks, and remove the fault."""
    with warnings.catch_warnings():
        for kind in (LawRangeWarning, RuntimeWarning):
            warnings.simplefilter("ignore", kind)
        sound = _sound(tuple(pair.to_toml() for pair in pairs(fault)))
        started = time.perf_counter()
        size = 0.0
        quantity = ""
        caught: dict[str, tuple[str, ...]] = {}
        stopped: list[tuple[Callable[[GearPair], list[str]], GearPair]] = []
        with applied(fault):
            made = list(_made(fault, caught))
            for (old, _), pair in zip(sound, made, strict=False):
                try:
                    size, quantity = max((size, quantity), change(old, quantities(pair)))
                except Exception as error:  # noqa: BLE001  (whatever stops a program with a fault is seen)
                    size = float("inf")
                    caught["refused"] = (_line(error),)
            for part, checks in _CHECKS.items():
                if not thorough and any(caught.values()):
                    break
                names: list[str] = []
                for (_, differences_without_fault), pair in zip(sound, made, strict=False):
                    if thorough or not names:
                        failing_here = _failing(checks, pair)
                        stopped += [(checks, pair) for name in failing_here if isinstance(name, Stop)]
                        names += [name for name in failing_here if name not in differences_without_fault]
                caught[part] = tuple(dict.fromkeys(names))
            if fault.test and not any(caught.values()) and _fails(fault.test):
                file, _, name = fault.test.partition("::test_")
                caught["tests"] = (f"{file}: {name.replace('_', ' ')}",)
        for checks, pair in stopped:
            again = [name for name in _failing(checks, pair) if isinstance(name, Stop)]
            assert not again, f"{checks.__name__} stops without a fault too: {again[0]}"
    if not made:
        size = float("inf")
    return Outcome(size, quantity, caught, time.perf_counter() - started)


@lru_cache(maxsize=64)
def _sound(texts: tuple[str, ...]) -> tuple[tuple[Mapping[str, FloatArray], list[str]], ...]:
    """Quantities of the sound program, and differences between both models, for pairs given as text."""
    made = [load_gear_pair(tomllib.loads(text)) for text in texts]
    return tuple((quantities(pair), _failing(_crossed, pair)) for pair in made)


def _made(fault: Fault, caught: dict[str, tuple[str, ...]]) -> Iterator[GearPair]:
    """Yield the pairs of the program with the fault. A refused pair counts as a caught fault."""
    try:
        yield from pairs(fault, wrong=True)
    except Exception as error:  # noqa: BLE001  (whatever stops a program with a fault is seen)
        caught["refused"] = (_line(error),)


def _fails(test: str) -> bool:
    """Whether a test fails as the program is now."""
    with redirect_stdout(StringIO()):
        code = pytest.main(["-x", "-p", "no:cacheprovider", test])
    assert code in (pytest.ExitCode.OK, pytest.ExitCode.TESTS_FAILED), f"{test} is no test"
    return code == pytest.ExitCode.TESTS_FAILED


class Stop(str):
    """The error with which checks stopped, in a line."""


def _failing(checks: Callable[[GearPair], list[str]], pair: GearPair) -> list[str]:
    try:
        return checks(pair)
    except Exception as error:  # noqa: BLE001  (as above)
        return [Stop(_line(error))]


def _line(error: Exception) -> str:
    return f"{type(error).__name__}: {str(error).splitlines()[0][:80] if str(error) else ''}"


def _crossed(pair: GearPair) -> list[str]:
    """Checks of the program that fail, and quantities in which the exact model differs, the loss as well."""
    check = crosscheck(pair, cycles=_CYCLES, samples_per_cycle=_SAMPLES, supports="springs")
    differing = [one.quantity for one in check.of("exact") if not one.within]
    if check.loss is not None and not check.loss.within:
        differing.append("loss")
    return [*(one.check for one in check.failures), *(f"differs: {name}" for name in differing)]


def _reported(pair: GearPair) -> list[str]:
    """Relations between the numbers of every report, quick ones too."""
    return list(broken_relations(Results(pair, QUICK)))


def _refined(pair: GearPair) -> list[str]:
    return [refinement.key for refinement in refinements(pair, _SAMPLES) if not refinement.passes]


def _evidence(pair: GearPair) -> list[str]:
    """Checks of the evidence, which the tests make, of pairs on springs."""
    pair_on_springs = without_shafts(pair)
    return [check.subject for _, compute in OF_PAIRS.values() for check in failing(compute(pair_on_springs))]


#: Part of the program or of its tests -> names of the checks that fail.
_CHECKS: Mapping[str, Callable[[GearPair], list[str]]] = {
    "cross-check": _crossed, "report": _reported, "full report": _refined, "tests": _evidence,
}  # fmt: skip

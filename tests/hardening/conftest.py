"""Strategies for gear pairs, valid and hostile, and a watch against calls that do not end.

For a long run set the environment variable SPURCHECK_FUZZ, see tests/conftest.py.
"""

import contextlib
import copy
import math
import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager
from typing import Any

import pytest
from hypothesis import reject
from hypothesis import strategies as st

from lumped import GearPair, load_gear_pair, preset_names
from lumped.errors import ParameterError


@pytest.fixture(autouse=True)
def bounded_memory() -> Iterator[None]:
    """A file without end, read whole, would take the machine down instead of failing a test."""
    if sys.platform != "linux":
        yield
        return
    import resource

    before = resource.getrlimit(resource.RLIMIT_AS)
    resource.setrlimit(resource.RLIMIT_AS, (16 << 30, before[1]))
    yield
    # Other tests of the same process start programs that want more addresses, as browsers do.
    resource.setrlimit(resource.RLIMIT_AS, before)


class Hang(BaseException):
    """Raised in a call that takes too long; no handler for errors catches it."""


@pytest.fixture(scope="session")
def within() -> Callable[[float], AbstractContextManager[None]]:
    """Fail a block that takes longer than some seconds."""

    @contextlib.contextmanager
    def limit(seconds: float) -> Iterator[None]:
        def expired(number: int, frame: Any) -> None:
            raise Hang(f"longer than {seconds} s")

        before = signal.signal(signal.SIGALRM, expired)
        signal.setitimer(signal.ITIMER_REAL, seconds)
        try:
            yield
        finally:
            signal.setitimer(signal.ITIMER_REAL, 0.0)
            signal.signal(signal.SIGALRM, before)

    return limit


def log_range(low: float, high: float) -> st.SearchStrategy[float]:
    """Numbers spread evenly over the decades from low to high."""
    return st.floats(math.log10(low), math.log10(high)).map(lambda power: float(10.0**power))


STIFFNESS = st.one_of(
    st.just({"model": "rectangular"}),
    st.builds(lambda k: {"model": "rectangular", "pair_stiffness": k}, log_range(1e6, 1e10)),
    st.builds(
        lambda k, ratio: {"model": "parabolic", "peak": k, "end_ratio": ratio},
        log_range(1e6, 1e10),
        st.floats(0.2, 1.0),
    ),
)
FRICTION = st.one_of(
    st.just({"law": "none"}),
    st.builds(lambda mu: {"law": "coulomb", "coefficient": mu}, st.floats(0.0, 0.3)),
    st.builds(lambda mu: {"law": "smoothed_coulomb", "coefficient": mu}, st.floats(0.0, 0.3)),
    st.sampled_from([{"law": "benedict_kelley"}, {"law": "xu_kahraman"}, {"law": "composite"}]),
)


@st.composite
def gear_pairs(draw: Callable[..., Any]) -> GearPair:
    """Pairs that exist: tooth forms of everyday, everything else over many decades."""
    module = draw(log_range(0.3, 30.0))
    bearing = {
        f"{direction}_{what}": draw(values)
        for direction in ("loa", "oloa")
        for what, values in (("stiffness", log_range(1e6, 1e10)), ("damping_ratio", st.floats(0.0, 0.2)))
    }
    gears = [
        {
            "teeth": draw(st.integers(20, 90)), "face_width": module * draw(st.floats(2.0, 15.0)),
            "profile_shift": draw(st.floats(0.0, 0.3)), "roughness": draw(st.floats(0.05, 0.8)),
            "bore": module * draw(st.floats(0.0, 8.0)),
        }
        for _ in range(2)
    ]  # fmt: skip
    data = {
        "name": "drawn",
        "basic_rack": {"module": module, "pressure_angle": draw(st.floats(20.0, 25.0))},
        "pinion": gears[0],
        "gear": gears[1],
        "bearings": {"pinion": bearing, "gear": bearing},
        "mesh": {
            "stiffness": draw(STIFFNESS), "damping_ratio": draw(st.floats(0.0, 0.3)),
            "backlash": 0.02 * module, "contact": draw(st.sampled_from(["prescribed", "loaded"])),
        },
        "lubricant": {"viscosity": draw(st.floats(4.0, 50.0))},
        "friction": draw(FRICTION),
        "operating": {
            "pinion_speed": draw(log_range(500.0, 20000.0)),
            "pinion_torque": module**3 * draw(st.floats(0.2, 5.0)),
        },
    }  # fmt: skip
    try:
        return load_gear_pair(data)
    except ParameterError:  # a combination that the schema refuses
        reject()


@pytest.fixture(scope="session")
def pairs() -> st.SearchStrategy[GearPair]:
    """Strategy of valid gear pairs."""
    return gear_pairs()


#: What no field expects: limits of numbers, text that looks like code, other types, other sizes.
HOSTILE = st.one_of(
    st.sampled_from(
        [
            None, True, 0, -1, -0.0, 1e-320, 5e-324, 1e308, -1e308, math.nan, math.inf, -math.inf, 10**400,
            2**63, "", " ", "nan", "inf mm", "1e400 mm", "1e999999999 mm", "9**9**9**9 mm", "10**(10**10) m",
            "mm", "1 mm/0", "1 furlong", "3 mm; import os", "__import__('os').system('touch owned')",
            "{{7*7}}", "%s%n", "<script>alert(1)</script>", "../../etc/passwd", "/dev/zero", "\x00", "\ud800",
            "١ mm", "1" * 5000, "(" * 2000, b"bytes", object(), [], {}, [[]], [1] * 1000,
            {"a": {"b": {"c": 1}}}, {"model": "table", "file": "/dev/zero"},
            {"model": "table", "file": "../../../etc/passwd"}, {"model": "nonsense"}, ["loa", None],
        ]
    ),
    st.floats(),
    st.integers(),
    st.text(max_size=30),
)  # fmt: skip


@pytest.fixture(scope="session")
def hostile_values() -> st.SearchStrategy[Any]:
    """Strategy of values that hardly any field allows."""
    return HOSTILE


@pytest.fixture(scope="session")
def hostile_mappings() -> st.SearchStrategy[dict[str, Any]]:
    """Strategy of preset mappings with one to four entries replaced, removed or added."""
    presets = [load_gear_pair(name).to_mapping() for name in preset_names()]

    @st.composite
    def mappings(draw: Callable[..., Any]) -> dict[str, Any]:
        data = copy.deepcopy(draw(st.sampled_from(presets)))
        for _ in range(draw(st.integers(1, 4))):
            node = data
            while True:
                key = draw(st.sampled_from([*sorted(node, key=str), "new key"]))
                inner = node.get(key)
                if isinstance(inner, dict) and inner and draw(st.booleans()):
                    node = inner
                    continue
                if draw(st.integers(0, 4)):
                    node[key] = copy.deepcopy(draw(HOSTILE))
                else:
                    node.pop(key, None)
                break
        return data

    return mappings()

"""Does a signal stop a command wherever it arrives, with its own exit code?"""

import os
import signal
import subprocess
import sys
from contextlib import suppress

import pytest

from validation.stop_signals import interrupt_once, interruption_kept

pytestmark = pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")

#: A signal arrives in a compiled function, which is long and returns records in a record.
IN_COMPILED_CODE = """
import os, signal, threading, time
from typing import NamedTuple
import numba
from validation.stop_signals import interrupt_once

class Size(NamedTuple):
    value: float

class Both(NamedTuple):
    first: Size
    second: Size

@numba.njit(nogil=True)
def slow(count):
    total = 0.0
    for i in range(count):
        total += (i % 7) ** 0.5
    return Both(Size(total), Size(-total))

slow(1)
begun = time.perf_counter()
slow(10_000_000)
count = int(1e7 * 0.4 / (time.perf_counter() - begun))
signal.signal(signal.SIGINT, signal.default_int_handler)  # children of a background shell ignore it
interrupt_once()
threading.Timer(0.1, os.kill, (os.getpid(), signal.SIGINT)).start()
try:
    slow(count)
    len("behind")
    print("not stopped")
except KeyboardInterrupt:
    print("stopped")
"""

#: A signal arrives in a function that a library in C calls: Python ignores its errors.
IN_A_CALLBACK = """
import ctypes, os, signal
from validation.stop_signals import interrupt_once
signal.signal(signal.SIGINT, signal.default_int_handler)
interrupt_once()
function = ctypes.CFUNCTYPE(None)(lambda: os.kill(os.getpid(), signal.SIGINT))
try:
    function()
    len("behind")
    print("not stopped")
except KeyboardInterrupt:
    print("stopped")
"""

#: A library makes another error of the signal, in the place of the report.
IN_A_LIBRARY = """
import os, signal, sys, types
signal.signal(signal.SIGINT, signal.default_int_handler)
from validation.cli import main
def report(*arguments, **options):
    try:
        os.kill(os.getpid(), signal.SIGINT)
    except KeyboardInterrupt:
        {error}
sys.modules["validation.reporting.build"] = types.SimpleNamespace(report=report)
sys.argv[1:] = ["report", "nasa_28_28"]
main()
"""


@pytest.fixture
def handlers():
    """The handlers of this process are as before, after the test."""
    hook = sys.unraisablehook
    numbers = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
    before = {number: signal.getsignal(number) for number in numbers}
    for number in numbers:
        signal.signal(number, signal.SIG_DFL)
    interrupt_once()
    yield
    sys.unraisablehook = hook
    for number, handler in before.items():
        signal.signal(number, handler)


@pytest.mark.parametrize("program", [IN_COMPILED_CODE, IN_A_CALLBACK], ids=["compiled code", "callback"])
def test_a_signal_where_python_can_raise_no_error_stops_behind_it(program):
    """Where numba makes objects of results KeyboardInterrupt would crash the process; others ignore it."""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (0, "stopped\n", "")


@pytest.mark.parametrize(
    "error",
    ["raise ImportError('initialization failed')", "raise OSError('wrapped')", "raise"],
    ids=["import", "file", "none"],
)
def test_a_signal_has_its_exit_code_whatever_a_library_makes_of_it(error, tmp_path):
    command = [sys.executable, "-c", IN_A_LIBRARY.format(error=error)]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr.strip()) == (130, "error: interrupted")


def test_an_error_after_a_signal_is_the_interruption(handlers):
    with suppress(KeyboardInterrupt):
        os.kill(os.getpid(), signal.SIGINT)
    with pytest.raises(KeyboardInterrupt), interruption_kept():
        raise ImportError("initialization failed")


def test_a_command_that_has_told_its_interruption_ends_as_it_says(handlers):
    with suppress(KeyboardInterrupt):
        os.kill(os.getpid(), signal.SIGINT)
    with pytest.raises(LookupError, match="told"), interruption_kept(LookupError):
        raise KeyError("told")


#: A module that ends the process with 99 when Python takes it down, and a function at its exit.
ENDING = """
import atexit, os, signal, sys
from validation.stop_signals import ended_at_once, interrupt_once

class Crash:
    def __del__(self, end=os._exit):
        end(99)

interrupt_once()
with ended_at_once():
    atexit.register(print, "told at exit")
    kept = Crash()
    def work():
        on_the_way = Crash()
        try:
            {stop}
        finally:
            sys.exit(7)
    work()
"""


@pytest.mark.parametrize(("stop", "code"), [("os.kill(os.getpid(), signal.SIGTERM)", 7), ("pass", 99)])
def test_a_stopped_process_does_not_take_its_modules_down(stop, code, tmp_path):
    """numba's compiler, stopped in its work, would free parts of a kernel twice."""
    command = [sys.executable, "-c", ENDING.format(stop=stop)]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == code
    assert done.stdout.strip() == "told at exit" or stop == "pass"


def test_an_error_without_a_signal_is_itself(handlers):
    with pytest.raises(ImportError, match="no library"), interruption_kept():
        raise ImportError("no library")


def test_the_next_command_forgets_the_signal(handlers):
    with pytest.raises(KeyboardInterrupt):
        os.kill(os.getpid(), signal.SIGTERM)
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.SIG_DFL)
    interrupt_once()
    with pytest.raises(ImportError), interruption_kept():
        raise ImportError

"""Compilation during the first run on a machine.

The first run compiles for about a minute, and the progress bar shows the number of compiled functions. Of a
cross-check a second process compiles the second program meanwhile; the second process of a report, see
``validation.reporting.second_process``, compiles what it computes.
"""

from __future__ import annotations

import gc
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from lumped.typing import Progress


@contextmanager
def counted(bar: Progress) -> Iterator[Progress]:
    """Count compiled functions while the block runs. Yields the progress function for the block."""
    from numba.core import event

    event.Listener.register(_Listener)
    listener = _Listener(bar)
    event.register("numba:compile", listener)
    try:
        yield listener.tell
    finally:
        event.unregister("numba:compile", listener)


@contextmanager
def compiling(bar: Progress) -> Iterator[Progress]:
    """Compile the multibody model in a second process while the block runs. Yields the progress function.

    Meanwhile the block compiles the lumped model with contact loss. If both processes need the same kernel,
    the second waits until the first has compiled the kernel.
    """
    from lumped.cache import cores

    helper = _start() if cores() > 1 and not _all_stored() else None
    try:
        with counted(bar) as tell:
            yield tell
    finally:
        if helper is not None:
            helper.kill()
            helper.wait()


def _all_stored() -> bool:
    from lumped.compiler import is_stored
    from multibody.run.integration import bridge

    return is_stored(bridge)


def _start() -> subprocess.Popen[bytes]:
    """Start this file as a program. -P: a folder of the user cannot replace a package of the same name."""
    nothing = subprocess.DEVNULL
    command = [sys.executable, "-P", "-m", "validation.commands.kernels"]
    return subprocess.Popen(command, stdin=nothing, stdout=nothing, stderr=nothing)


class _Listener:
    """Adds the number of functions that numba has compiled to the progress of the work."""

    def __init__(self, bar: Progress) -> None:
        self._bar = bar
        self._done = 0
        self._fraction = 0.0

    def tell(self, fraction: float, stage: str = "", /) -> None:
        """Take the progress of the work and store the fraction."""
        self._fraction = fraction
        self._bar(fraction, stage)

    def notify(self, event: Any) -> None:
        """Take one event of numba: the start or the end of a compilation."""
        self._done += event.is_end
        # Not "of": how many a pair needs, and which the second process compiles, is known at the end.
        done = f"{self._done} functions"
        self._bar(self._fraction, f"compiling, once for this machine, for a minute: {done}")


def main() -> None:
    """Compute a multibody motion. Numba stores the compiled kernels."""
    gc.set_threshold(5_000_000)  # as in the command itself; by default a tenth of the time goes there
    import multibody
    from lumped import load_gear_pair

    multibody.steady_state(load_gear_pair("nasa_28_28"), samples_per_cycle=32)


if __name__ == "__main__":
    main()

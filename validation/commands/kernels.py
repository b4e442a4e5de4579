"""Compilation during the first run on a machine.

The first run compiles for about a minute. A second process compiles at the same time, and the progress bar
shows the number of compiled functions.
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

#: Functions that a report compiles, with nested functions (counted on an empty cache, numba 0.63).
_FUNCTIONS = 150


@contextmanager
def compiling(bar: Progress) -> Iterator[Progress]:
    """Compile in a second process while the block runs. Yields the progress function for the block.

    The second process compiles the multibody model and the stability charts, which the block needs last.
    Meanwhile the block compiles the lumped model with contact loss and computes samples. If both processes
    need the same kernel, the second waits until the first has compiled the kernel.
    """
    from numba.core import event

    from lumped.cache import cores

    event.Listener.register(_Listener)
    listener = _Listener(bar)
    event.register("numba:compile", listener)
    helper = _start() if cores() > 1 and not _all_stored() else None
    try:
        yield listener.tell
    finally:
        event.unregister("numba:compile", listener)
        if helper is not None:
            helper.kill()
            helper.wait()


def _all_stored() -> bool:
    from floquet.rank_one.kernels.taylor import propagate_points
    from lumped.compiler import is_stored
    from multibody.run.integration import bridge

    return is_stored(propagate_points) and is_stored(bridge)


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
        share = f"{self._done} of about {_FUNCTIONS} functions"
        self._bar(self._fraction, f"compiling, once for this machine, for a minute: {share}")


def main() -> None:
    """Compute a multibody motion and a chart of one point. Numba stores the compiled kernels."""
    gc.set_threshold(1_000_000)  # as in the command itself; by default a tenth of the time goes there
    import floquet
    import multibody
    from lumped import load_gear_pair

    pair = load_gear_pair("nasa_28_28")
    multibody.steady_state(pair, samples_per_cycle=32)
    floquet.stability_chart(pair, {"speed_rpm": [4000.0]})


if __name__ == "__main__":
    main()

"""A second process computes samples of the inputs while this process computes the rest of a report.

Samples take more than half of a report, and need no other result of it. The second process computes the
``uncertainty`` of a pair, then the samples of its band over speed from the first one on. This process takes
the samples of the band from the last one on, as soon as it has nothing else to do, until both meet. Both
processes compute the same functions of the same arguments: the results do not depend on which one computed a
sample. If the second process fails, this process computes everything.

The second process pays where the compiled kernels are stored. Where they are not,
``validation.commands.kernels`` needs the second core.
"""

from __future__ import annotations

import importlib
import os
import pickle
import subprocess
import sys
import threading
import time
import warnings
from contextlib import suppress
from typing import IO, Any, NamedTuple

import xarray as xr

from lumped.errors import LawRangeWarning, SpurcheckError
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray
from validation.prediction.uncertainty import peaks_of_samples, uncertainty


class SampleRequest(NamedTuple):
    """What the second process computes.

    Attributes
    ----------
    pair : the gear pair with like teeth
    samples, sample_seconds : arguments of ``uncertainty``
    pair_on_springs : the pair of the band over speed
    speeds_rpm, band_samples, step_angle, band_seconds : arguments of ``speed_band``
    """

    pair: GearPair
    samples: int
    sample_seconds: float | None
    pair_on_springs: GearPair
    speeds_rpm: FloatArray
    band_samples: int
    step_angle: float
    band_seconds: float | None


class SampleAnswer(NamedTuple):
    """One sample of the band over speed.

    Attributes
    ----------
    peaks : (speeds,) peak to peak [m]; None: the sample has no motion
    seconds : processor time of all samples so far [s]
    """

    peaks: FloatArray | None
    seconds: float


class SecondProcess:
    """The second process, from its start to ``close``. The answers are read by a thread as they come."""

    def __init__(self) -> None:
        command = [sys.executable, "-P", "-m", "validation.prediction.second_process"]
        pipe = subprocess.PIPE
        self._process = subprocess.Popen(command, stdin=pipe, stdout=pipe, stderr=subprocess.DEVNULL)
        self._changed = threading.Condition()
        self._uncertainty: xr.Dataset | None = None
        self._answers: list[SampleAnswer] = []
        self._ended = False
        self._request: SampleRequest | None = None

    def compute(self, request: SampleRequest) -> None:
        """Send the request. The answers arrive while this process goes on."""
        self._request = request
        threading.Thread(target=self._read, args=(request,), daemon=True).start()

    def _read(self, request: SampleRequest) -> None:
        stdin = self._process.stdin
        stdout = self._process.stdout
        assert stdin is not None
        assert stdout is not None
        try:
            pickle.dump(request, stdin)
            stdin.flush()
            while True:
                answer = pickle.load(stdout)
                with self._changed:
                    if isinstance(answer, SampleAnswer):
                        self._answers.append(answer)
                    else:
                        self._uncertainty = answer
                    self._changed.notify_all()
        except (OSError, EOFError, ValueError, pickle.UnpicklingError):
            pass  # the process has ended
        finally:
            with self._changed:
                self._ended = True
                self._changed.notify_all()

    def uncertainty(self, pair: GearPair, samples: int) -> xr.Dataset | None:
        """Wait for the result of ``uncertainty``. None: another request was sent, or the process failed."""
        if self._request is None or (self._request.pair, self._request.samples) != (pair, samples):
            return None
        with self._changed:
            self._changed.wait_for(lambda: self._ended or self._uncertainty is not None)
        return self._uncertainty

    @property
    def count(self) -> int:
        """Number of samples of the band whose results have arrived."""
        return len(self._answers)

    @property
    def seconds(self) -> float:
        """Processor time of these samples in the second process [s]."""
        return self._answers[-1].seconds if self._answers else 0.0

    def first(self, count: int) -> list[FloatArray | None]:
        """Wait for the results of the first samples of the band; fewer where the process ended before."""
        with self._changed:
            self._changed.wait_for(lambda: self._ended or len(self._answers) >= count)
        return [answer.peaks for answer in self._answers[:count]]

    def close(self) -> None:
        """End the process."""
        self._process.kill()
        self._process.wait()
        for stream in (self._process.stdin, self._process.stdout):
            if stream is not None:
                with suppress(OSError):
                    stream.close()


def answer(request: SampleRequest, output: IO[bytes]) -> None:
    """Compute a request and write the answers: the dataset of ``uncertainty``, then the band's samples."""

    def write(one: Any) -> None:
        pickle.dump(one, output)
        output.flush()

    result = uncertainty(request.pair, request.samples, seconds=request.sample_seconds)
    write(result)
    start = time.process_time()
    for peaks in peaks_of_samples(
        request.pair_on_springs,
        request.speeds_rpm,
        result,
        request.band_samples,
        request.step_angle,
        request.band_seconds,
    ):
        write(SampleAnswer(peaks, time.process_time() - start))


def main() -> None:
    """Read one request and answer it. The process ends at an error: the first process then computes."""
    warnings.simplefilter("ignore", LawRangeWarning)
    output = os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())  # a library that prints cannot disturb the answers
    with suppress(SpurcheckError, EOFError, BrokenPipeError, KeyboardInterrupt):
        answer(pickle.load(sys.stdin.buffer), output)


if __name__ == "__main__":
    # The classes of this file must have the name of the module in the answers.
    importlib.import_module("validation.prediction.second_process").main()

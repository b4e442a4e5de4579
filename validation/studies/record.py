"""The outcome of one case, and its form in the journal: length, content, checksum."""

from __future__ import annotations

import struct
import zlib
from dataclasses import dataclass
from enum import IntEnum

MAGIC = b"\xc5SPc"
_HEAD = struct.Struct("<4sIQBf")
_CRC = struct.Struct("<I")
#: Longest error text kept with a case, in bytes.
MAX_MESSAGE = 2000


class Status(IntEnum):
    """What became of a case."""

    MISSING = -1
    OK = 0
    OUTSIDE_LAW_RANGE = 1
    REFUSED = 2
    NUMERICAL = 3
    UNEXPECTED = 4
    WORKER_DIED = 5
    TIME_LIMIT = 6
    SESSION = 100

    @property
    def failed(self) -> bool:
        """Whether there are no outputs."""
        return self >= Status.REFUSED


MEANINGS = {
    Status.MISSING: "not computed yet",
    Status.OK: "computed",
    Status.OUTSIDE_LAW_RANGE: "computed, a friction or film law outside the range it was fitted in",
    Status.REFUSED: "the combination of parameters was refused",
    Status.NUMERICAL: "the analysis did not reach its accuracy",
    Status.UNEXPECTED: "an unexpected error",
    Status.WORKER_DIED: "the worker process died on this case",
    Status.TIME_LIMIT: "the time limit of a case was exceeded",
    Status.SESSION: "no case: a run of the study began, the text says with which versions",
}


@dataclass(frozen=True)
class Record:
    """Outcome of one case.

    Attributes
    ----------
    case : its number
    status : what became of it
    seconds : time it took
    values : outputs, () when it failed
    message : error or warning text, "" when there is none
    """

    case: int
    status: Status
    seconds: float
    values: tuple[float, ...] = ()
    message: str = ""


def encode(record: Record, outputs: int, seed: int) -> bytes:
    """Bytes of a record: head, outputs as little-endian doubles (none when failed), text, CRC-32.

    Parameters
    ----------
    record : the outcome
    outputs : number of outputs of the study
    seed : start of the checksum, so that a record of another study never passes
    """
    if len(record.values) != (0 if record.status.failed else outputs):
        raise ValueError(f"case {record.case}: {len(record.values)} values for {outputs} outputs")
    # "ignore" drops a character cut in half and lone surrogates, which UTF-8 does not have.
    text = record.message.encode("utf-8", "ignore")[:MAX_MESSAGE].decode("utf-8", "ignore").encode()
    content = struct.pack(f"<{len(record.values)}d", *record.values) + text
    body = _HEAD.pack(MAGIC, len(content), record.case, record.status, record.seconds) + content
    return body + _CRC.pack(zlib.crc32(body, seed))


def decode(data: bytes, at: int, outputs: int, seed: int) -> tuple[Record, int] | None:
    """Read the record that starts at ``at``; None where there is no whole, undamaged record.

    Returns
    -------
    the record and where the next one starts
    """
    start = at + _HEAD.size
    if start + _CRC.size > len(data):
        return None
    magic, length, case, code, seconds = _HEAD.unpack_from(data, at)
    end = start + length
    if magic != MAGIC or length > 8 * outputs + MAX_MESSAGE or end + _CRC.size > len(data):
        return None
    if zlib.crc32(memoryview(data)[at:end], seed) != _CRC.unpack_from(data, end)[0]:
        return None
    if code not in MEANINGS:
        return None
    status = Status(code)
    count = 0 if status.failed else outputs
    values = struct.unpack_from(f"<{count}d", data, start)
    message = data[start + 8 * count : end].decode("utf-8", "replace")
    return Record(case, status, seconds, values, message), end + _CRC.size

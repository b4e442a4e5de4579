"""Does the journal give back every whole record, and never a damaged one?"""

from __future__ import annotations

import hashlib
import math
import os
import stat
import struct
import sys
import zlib

import pytest
from hypothesis import given
from hypothesis import strategies as st

from lumped.errors import ParameterError, SpurcheckError
from lumped.fields.text_file import read_text
from validation.files.regular import StoreError, read_bytes, replaced, write_text
from validation.studies.cases import case_list
from validation.studies.journal import NOTHING, Journal, Key, scan
from validation.studies.record import MAX_MESSAGE, Record, Status, decode, encode

texts = st.text(max_size=60) | st.just("x" * 5000) | st.just("é" * MAX_MESSAGE)
COMPUTED = [Status.OK, Status.OUTSIDE_LAW_RANGE]
records = st.one_of(
    st.builds(
        Record,
        case=st.integers(0, 2**64 - 1),
        status=st.sampled_from(COMPUTED),
        seconds=st.floats(0, 1e6, width=32),
        values=st.tuples(st.floats(), st.floats()),
        message=texts,
    ),
    st.builds(
        Record,
        case=st.integers(0, 2**64 - 1),
        status=st.sampled_from([s for s in Status if s.failed]),
        seconds=st.floats(0, 1e6, width=32),
        message=texts,
    ),
)


def bits(values):
    return struct.pack(f"<{len(values)}d", *values)


@given(records, st.integers(0, 2**32 - 1))
def test_a_record_comes_back_bit_for_bit(record, seed):
    data = encode(record, 2, seed)
    read, after = decode(data, 0, 2, seed)
    assert after == len(data)
    assert (read.case, read.status, read.seconds) == (record.case, record.status, record.seconds)
    assert bits(read.values) == bits(record.values)
    kept = record.message.encode("utf-8", "ignore")[:MAX_MESSAGE].decode("utf-8", "ignore")
    assert read.message == kept


@given(records, st.integers(0, 2**32 - 1))
def test_a_record_of_another_study_does_not_pass(record, seed):
    assert decode(encode(record, 2, seed), 0, 2, seed ^ 1) is None


@given(records, st.data())
def test_no_flipped_bit_passes(record, data):
    # CRC-32 finds every single-bit error; the length field is checked before it is trusted.
    whole = bytearray(encode(record, 2, 7))
    bit = data.draw(st.integers(0, 8 * len(whole) - 1))
    whole[bit // 8] ^= 1 << bit % 8
    assert decode(bytes(whole), 0, 2, 7) is None


#: Codes in the stores that users have: a new meaning takes a new number, none is ever given away again.
CODES = {
    "OK": 0,
    "OUTSIDE_LAW_RANGE": 1,
    "REFUSED": 2,
    "NUMERICAL": 3,
    "UNEXPECTED": 4,
    "WORKER_DIED": 5,
    "TIME_LIMIT": 6,
    "SESSION": 100,
}


def stored(code, content, case=7, seed=9):
    """A record by the description of its format, every number little-endian."""
    head = b"\xc5SPc" + struct.pack("<IQBf", len(content), case, code, 0.5) + content
    return head + struct.pack("<I", zlib.crc32(head, seed))


def test_the_format_is_that_of_the_stores_there_are():
    assert {status.name: int(status) for status in Status if status is not Status.MISSING} == CODES
    for name, code in CODES.items():
        values = () if Status[name].failed else (1.5, -0.0)
        data = stored(code, struct.pack(f"<{len(values)}d", *values) + "é".encode())
        record = Record(7, Status[name], 0.5, values, "é")
        assert encode(record, 2, 9) == data
        assert decode(data, 0, 2, 9) == (record, len(data))


@pytest.mark.parametrize("code", [7, 99, 255])  # 255: the byte of MISSING, which is never written
def test_a_status_that_only_a_later_version_knows_is_no_record(code):
    assert decode(stored(code, b""), 0, 2, 9) is None


def sample_records(count):
    values = [Record(j, Status.OK, 0.5, (math.sqrt(j), -float(j))) for j in range(count)]
    values[2] = Record(2, Status.NUMERICAL, 0.5, message="did not converge")
    return values


@pytest.fixture
def journal(study, tmp_path):
    """Key, file and the ten records written to it."""
    key, path, written = Key(case_list(study)), tmp_path / "journal.bin", sample_records(10)
    with Journal(path, key) as file:
        file.append(written[:4])
        file.append(written[4:])
    return key, path, written


def read(path, key):
    found = []
    return found, scan(path, key, found.append)


def test_what_was_appended_is_read_in_order(journal):
    key, path, written = journal
    found, result = read(path, key)
    assert found == written
    assert result.damaged_bytes == 0
    assert result.end == path.stat().st_size


def test_cut_anywhere_the_records_before_the_cut_survive(journal):
    key, path, written = journal
    data = path.read_bytes()
    ends = [len(key.header)]
    while ends[-1] < len(data):
        ends.append(decode(data, ends[-1], key.outputs, key.seed)[1])
    for size in range(len(data)):
        path.write_bytes(data[:size])
        found, result = read(path, key)
        whole = max((j for j, end in enumerate(ends) if end <= size), default=0)
        assert found == written[:whole]
        assert result.damaged_bytes == max(size - ends[whole], 0)


def test_damaged_anywhere_only_the_record_itself_is_lost(journal):
    key, path, written = journal
    data = path.read_bytes()
    for at in range(len(key.header), len(data)):
        changed = bytearray(data)
        changed[at] ^= 0xFF
        path.write_bytes(changed)
        found, result = read(path, key)
        assert len(found) == len(written) - 1
        assert [record for record in written if record in found] == found
        assert result.damaged_bytes > 0


def test_after_damage_appending_goes_on(journal):
    key, path, written = journal
    data = path.read_bytes()
    path.write_bytes(data[:-5])
    _, result = read(path, key)
    with Journal(path, key, result) as file:
        file.append([written[-1]])
    assert path.read_bytes() == data


@pytest.mark.parametrize("tail", [1, 7, 5000])
def test_opening_cuts_off_a_damaged_tail_however_long(journal, tail):
    key, path, written = journal
    data = path.read_bytes()
    # What a torn block leaves: zeros, and the start of a record whose rest never reached the disk.
    path.write_bytes(data + (b"\0" * tail + encode(written[0], key.outputs, key.seed)[:-1])[:tail])
    _, result = read(path, key)
    assert result.damaged_bytes == tail
    Journal(path, key, result).close()
    assert path.read_bytes() == data


@pytest.mark.parametrize("kept", [0, 1, 100])
def test_a_write_that_fails_in_the_middle_leaves_nothing_of_itself(journal, monkeypatch, kept):
    key, path, written = journal
    data = path.read_bytes()

    def full(descriptor, block):
        monkeypatch.setattr("validation.studies.journal.os.write", failing)
        return write(descriptor, bytes(block)[:kept])

    def failing(descriptor, block):
        raise OSError(28, "No space left on device")

    with Journal(path, key, read(path, key)[1]) as file:
        write = os.write
        monkeypatch.setattr("validation.studies.journal.os.write", full)
        with pytest.raises(StoreError, match="No space left"):
            file.append(written * 10)
        assert path.read_bytes() == data
        monkeypatch.undo()
        file.append(written[:1])  # and the next write stands where the failed one would have stood
    assert path.read_bytes() == data + encode(written[0], key.outputs, key.seed)


def test_a_damaged_header_is_repaired(journal):
    key, path, written = journal
    data = path.read_bytes()
    path.write_bytes(b"\0" * 20 + data[20:])
    found, result = read(path, key)
    assert found == written
    Journal(path, key, result).close()
    assert path.read_bytes() == data


def test_the_journal_of_another_study_is_refused(journal, make_study):
    _, path, _ = journal
    other = Key(case_list(make_study(outputs=["contact_ratio", "base_pitch"])))
    with pytest.raises(ParameterError, match=r"this very study.*choose another --output"):
        read(path, other)


def test_the_journal_of_other_samples_of_the_study_is_refused(make_study, tmp_path):
    # As another version of scipy would draw them; the study itself is the same.
    axes = [{"field": "operating.pinion_speed", "low": 500, "high": 9000}]
    cases = case_list(make_study(design={"method": "sobol", "samples": 8}, axes=axes))
    key = Key(cases)
    other = case_list(cases.study)
    other.__dict__["sha256"] = hashlib.sha256(b"other samples").hexdigest()
    path = tmp_path / "journal.bin"
    with Journal(path, Key(other)) as file:
        file.append(sample_records(8))
    with pytest.raises(ParameterError, match=r"the same cases.*Another version of scipy"):
        read(path, key)
    # Nor do its records pass below a damaged header.
    path.write_bytes(b"\0" * 20 + path.read_bytes()[20:])
    assert read(path, key)[0] == []


def test_a_record_of_a_case_that_does_not_exist_is_left_out(journal):
    key, path, written = journal
    _, result = read(path, key)
    with Journal(path, key, result) as file:
        file.append([Record(key.count, Status.OK, 0.5, (1.0, 2.0))])
    assert read(path, key)[0] == written


def test_a_second_writer_is_refused(journal):
    key, path, _ = journal
    _, result = read(path, key)
    with Journal(path, key, result), pytest.raises(StoreError, match="another run is writing"):
        Journal(path, key, result)


def test_what_another_run_wrote_since_the_scan_is_not_cut_off(journal):
    key, path, written = journal
    _, result = read(path, key)
    with Journal(path, key, result) as file:
        file.append(written[:1])
    data = path.read_bytes()
    for seen in (result, NOTHING):  # the latter: a folder that was new when this run looked
        with pytest.raises(StoreError, match="another run wrote"):
            Journal(path, key, seen)
    assert path.read_bytes() == data


@pytest.mark.parametrize("kind", ["link", "pipe", "folder"])
def test_only_a_regular_file_is_opened(journal, tmp_path, kind):
    key, path, _ = journal
    target = tmp_path / "precious"
    target.write_bytes(b"do not touch")
    path.unlink()
    if kind == "link":
        path.symlink_to(target)
    elif kind == "pipe":
        os.mkfifo(path)
    else:
        path.mkdir()
    for use in (lambda: Journal(path, key), lambda: read(path, key)):
        with pytest.raises(StoreError):
            use()
    assert target.read_bytes() == b"do not touch"


def test_replacing_a_link_leaves_its_target_alone(tmp_path):
    target, link = tmp_path / "precious", tmp_path / "results.nc"
    target.write_bytes(b"do not touch")
    link.symlink_to(target)
    (tmp_path / ".results.nc.part").symlink_to(target)
    with replaced(link) as part:
        part.write_bytes(b"new")
    assert target.read_bytes() == b"do not touch"
    assert link.read_bytes() == b"new"
    assert not link.is_symlink()


def test_a_failed_replacement_keeps_the_old_file(tmp_path):
    path = tmp_path / "results.nc"
    path.write_bytes(b"old")

    def fail(error: BaseException, *, taken_away: bool) -> None:
        with replaced(path) as part:
            part.write_bytes(b"half")
            if taken_away:
                part.unlink()
            raise error

    for taken_away in (False, True):
        with pytest.raises(StoreError, match=r"No space.*--resume"):
            fail(OSError(28, "No space left on device"), taken_away=taken_away)
        with pytest.raises(KeyboardInterrupt):
            fail(KeyboardInterrupt(), taken_away=taken_away)
        assert path.read_bytes() == b"old"
        assert [p.name for p in tmp_path.iterdir()] == ["results.nc"]


@pytest.fixture
def disk(monkeypatch):
    """What is asked of the disk, in order: syncs with the size that they find, and renames."""
    asked: list[str] = []
    fsync, replace = os.fsync, os.replace

    def noted_fsync(descriptor):
        found = os.fstat(descriptor)
        asked.append("sync the folder" if stat.S_ISDIR(found.st_mode) else f"sync {found.st_size} bytes")
        fsync(descriptor)

    def noted_replace(part, path):
        asked.append("rename")
        replace(part, path)

    monkeypatch.setattr(os, "fsync", noted_fsync)
    monkeypatch.setattr(os, "replace", noted_replace)
    return asked


@pytest.mark.skipif(os.name != "posix", reason="folders can be synced on POSIX systems")
def test_a_new_file_is_on_the_disk_before_its_name_and_its_name_before_the_sweep_goes_on(disk, tmp_path):
    # A power failure between the three leaves the old file or the new one, never a name of an empty one.
    write_text(tmp_path / "study.toml", "12345")
    assert disk == ["sync 5 bytes", "rename", "sync the folder"]


@pytest.mark.parametrize(("after", "synced"), [(-1.0, ["append"]), (1e9, [])])
def test_records_are_on_the_disk_after_a_while_and_at_the_end(
    study, disk, tmp_path, monkeypatch, after, synced
):
    monkeypatch.setattr("validation.studies.journal.SYNC_SECONDS", after)
    key, path = Key(case_list(study)), tmp_path / "journal.bin"
    with Journal(path, key) as file:
        assert disk == [f"sync {len(key.header)} bytes"]
        file.append(sample_records(3))
        size = f"sync {path.stat().st_size} bytes"
        assert disk[1:] == [size for _ in synced]
    assert disk[1:] == [size for _ in [*synced, "close"]]


def test_a_disk_that_fails_when_it_is_synced_is_told_and_nothing_unsure_is_kept(journal, monkeypatch):
    key, path, written = journal
    data, found = path.read_bytes(), read(path, key)[1]
    told = r"Input/output error.*--resume"

    def failing(descriptor):
        raise OSError(5, "Input/output error")

    with monkeypatch.context() as patch:
        patch.setattr(os, "fsync", failing)
        with pytest.raises(StoreError, match=told):
            Journal(path, key, found)
    monkeypatch.setattr("validation.studies.journal.SYNC_SECONDS", -1.0)
    file = Journal(path, key, found)
    monkeypatch.setattr(os, "fsync", failing)
    with pytest.raises(StoreError, match=told):
        file.append(written[:1])
    assert path.read_bytes() == data
    with pytest.raises(StoreError, match=told):
        file.close()
    monkeypatch.undo()
    Journal(path, key, found).close()  # it is unlocked


@pytest.mark.skipif(sys.platform != "linux", reason="/proc of Linux")
def test_no_file_is_left_open(journal, make_study, tmp_path):
    # A worker or a notebook lives for thousands of reads, and systems give a process about 1000 open files.
    key, path, _ = journal
    other = Key(case_list(make_study(outputs=["contact_ratio", "base_pitch"])))
    (tmp_path / "large").write_bytes(b"12345")
    os.mkfifo(tmp_path / "pipe")
    before = len(os.listdir("/proc/self/fd"))
    found = read(path, key)[1]
    write_text(tmp_path / "text", "x")
    for fails in (
        lambda: read(path, other),
        lambda: Journal(path, key, NOTHING),
        lambda: read_bytes(tmp_path / "large", 4),
        lambda: read_bytes(tmp_path / "pipe", 4),
        lambda: read_text(tmp_path / "large", 4),
        lambda: read_text(tmp_path / "pipe", 4),
    ):
        with pytest.raises(SpurcheckError):
            fails()
    Journal(path, key, found).close()
    assert len(os.listdir("/proc/self/fd")) == before


@pytest.mark.parametrize("what", ["moved", "deleted", "replaced"])
def test_a_journal_that_is_taken_away_is_told_at_once_not_at_the_end(journal, monkeypatch, what):
    key, path, written = journal
    found, aside = read(path, key)[1], path.with_name("aside")
    monkeypatch.setattr("validation.studies.journal.SYNC_SECONDS", -1.0)
    file = Journal(path, key, found)
    path.rename(aside)
    if what == "replaced":
        path.write_bytes(aside.read_bytes())
    if what == "deleted":
        aside.unlink()
    with pytest.raises(StoreError, match="moved, deleted or replaced"):
        file.append(written[:1])
    with pytest.raises(StoreError, match="moved, deleted or replaced"):
        file.close()
    if what != "deleted":
        assert read(aside, key)[0] == written  # and it can be opened again where it is
        Journal(aside, key, found).close()

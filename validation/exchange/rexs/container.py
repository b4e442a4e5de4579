"""Opening and writing REXS files: XML, JSON, or one of them in a ZIP archive."""

from __future__ import annotations

import io
import struct
import zipfile
import zlib
from pathlib import Path, PurePosixPath

from lumped.arguments import file_path
from lumped.errors import ParameterError, refuse, shown
from lumped.fields.text_file import read_bytes
from validation.exchange.rexs.json_form import parse_json
from validation.exchange.rexs.model import RexsModel, broken
from validation.exchange.rexs.xml_form import parse_xml

#: Largest file, and largest model in an archive [bytes]: models of whole gear units with tables of results
#: have a few megabytes.
MAX_BYTES = 32_000_000
_MAX_MEMBERS = 10_000
_MODELS = (".rexs", ".rexsj", ".rexs.xml", ".rexs.json")
_PLAIN = (".xml", ".json")
_DAMAGED = (zipfile.BadZipFile, zlib.error, struct.error, OSError, EOFError, ValueError, RuntimeError)
#: Suffix of a file to write -> its form; ".rexsz" and ".rexs.zip" hold the XML form.
FORMS = {
    ".rexs": "xml",
    ".rexs.xml": "xml",
    ".rexsj": "json",
    ".rexs.json": "json",
    ".rexsz": "zip",
    ".rexs.zip": "zip",
}


def read_rexs(path: str | Path) -> RexsModel:
    """Read a REXS file; its content, not its name, decides which form it has.

    Parameters
    ----------
    path : XML, JSON or ZIP

    Raises
    ------
    ParameterError : no such file, too large, an archive that is hostile or has not exactly one model, or not
        a REXS model
    """
    path = file_path("path", path)
    data = read_bytes(path, MAX_BYTES, field="REXS file")
    if data[:2] == b"PK":
        data = _unzipped(data, path.name)
    start = data.removeprefix(b"\xef\xbb\xbf").lstrip()[:1]
    if start == b"{":
        model = parse_json(data, path.name)
    elif start == b"<" or data[:2] in (b"\xff\xfe", b"\xfe\xff"):
        model = parse_xml(data, path.name)
    else:
        raise broken(path.name, "it is neither XML nor JSON nor a ZIP archive")
    return model


def _unzipped(data: bytes, file: str) -> bytes:
    """Return the one model of an archive; nothing is ever written to disk."""
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            members = archive.infolist()
            if len(members) > _MAX_MEMBERS:
                raise broken(file, f"the archive has more than {_MAX_MEMBERS} members")
            member = _model_in(members, file)
            if member.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
                raise broken(file, f"the member {shown(member.filename)!r} is not compressed by 'deflate'")
            with archive.open(member) as stream:
                content = stream.read(MAX_BYTES + 1)  # the size that the archive states may be a lie
    except ParameterError:
        raise
    except _DAMAGED as error:
        # zipfile trusts the offsets of a damaged directory, so a bad seek is among what it raises.
        raise broken(file, f"the archive cannot be read: {error}") from None
    if len(content) > MAX_BYTES:
        raise broken(file, f"the model in the archive has more than {MAX_BYTES} bytes")
    return content


def _model_in(members: list[zipfile.ZipInfo], file: str) -> zipfile.ZipInfo:
    files = [
        m
        for m in members
        if not m.is_dir()
        and not m.filename.startswith("__MACOSX/")
        and not PurePosixPath(m.filename).name.startswith("._")
    ]
    found = [m for m in files if m.filename.lower().endswith(_MODELS)]
    found = found or [m for m in files if m.filename.lower().endswith(_PLAIN)]
    if len(found) != 1:
        raise broken(file, f"the archive has {len(found)} models instead of one")
    return found[0]


def form_of(path: Path) -> str:
    """Form of a file to write, from its suffix.

    Raises
    ------
    ParameterError : a suffix that the specification does not have
    """
    for suffix, form in FORMS.items():
        if path.name.lower().endswith(suffix):
            return form
    raise refuse("output", path, "a name ending in " + ", ".join(FORMS), "The suffix chooses the form.")


def zipped(data: bytes, name: str) -> bytes:
    """Put one file into an archive, with a fixed date so that equal models give equal bytes."""
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        member = zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0))
        member.compress_type = zipfile.ZIP_DEFLATED
        archive.writestr(member, data)
    return stream.getvalue()

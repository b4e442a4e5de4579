"""Are stages outside the model refused with the reason, and hostile files without harm?"""

import io
import random
import re
import tracemalloc
import zipfile

import pytest

import lumped
from lumped import ParameterError
from validation.exchange import gear_pair_from_rexs, write_rexs
from validation.exchange.rexs import encodings


def refused(path, stage=None):
    with pytest.raises(ParameterError) as error:
        gear_pair_from_rexs(path, stage)
    return str(error.value)


@pytest.mark.parametrize("helix", ["20", "-8.5", "0.001"])
def test_a_helical_stage_is_refused_with_its_helix_angle(xml, save, helix):
    message = refused(save(xml(helix=helix)))
    assert message.startswith(f"model.rexs: stage 1 = a helical stage, helix angle {float(helix):g} deg")
    assert "axial forces" in message


@pytest.mark.parametrize(("old", "new", "reason"), [
    ('id="22" type="cylindrical_gear"', 'id="22" type="ring_gear"', "a stage with an internal gear"),
    (">30</attribute>", ">-30</attribute>", "a stage with an internal gear"),
    ('id="22" type="cylindrical_gear"', 'id="22" type="worm_gear"',
     "a stage of cylindrical gear and worm gear"),
    ('type="cylindrical_stage"', 'type="bevel_stage"', "a bevel stage"),
    ('type="cylindrical_stage"', 'type="worm_stage"', "a worm stage"),
    ('type="cylindrical_stage"', 'type="general_stage"', "a general stage"),
    ('type="cylindrical_stage"', 'type="planetary_stage"', "a planetary stage"),
    ('type="gear_unit"', 'type="planetary_stage"', "a mesh of a planetary stage"),
])  # fmt: skip
def test_other_kinds_of_stages_are_refused_with_the_reason(xml, save, old, new, reason):
    text = xml()
    assert old in text
    assert refused(save(text.replace(old, new))).startswith(f"model.rexs: stage 1 = {reason}")


_SECOND = {
    "relations": '<relation id="80" type="stage"><ref id="11" role="stage"/><ref id="23" role="gear_1"/>'
    '<ref id="24" role="gear_2"/></relation>'
    + "".join(
        f'<relation id="{58 + i}" type="flank"><ref id="{i}" role="gear"/><ref id="43" role="left"/>'
        "</relation>"
        for i in (23, 24)
    ),
    "components": '<component id="11" type="cylindrical_stage" name="second stage"/>'
    + "".join(
        f'<component id="{i}" type="cylindrical_gear">'
        f'<attribute id="number_of_teeth" unit="none">{z}</attribute>'
        '<attribute id="normal_module" unit="mm">3</attribute>'
        '<attribute id="helix_angle_reference_diameter" unit="deg">{beta}</attribute>'
        '<attribute id="face_width" unit="mm">30</attribute></component>'
        for i, z in ((23, 19), (24, 50))
    ),
}


def two_stages(xml, beta):
    return xml(relations=_SECOND["relations"], components=_SECOND["components"].replace("{beta}", beta))


def test_of_several_spur_stages_one_has_to_be_chosen(xml, save):
    path = save(two_stages(xml, "0"))
    message = refused(path)
    assert "1: first stage (20/30)" in message
    assert "2: second stage (19/50)" in message
    assert gear_pair_from_rexs(path, 2)[0]["gear"]["teeth"] == 50
    assert gear_pair_from_rexs(path, 1)[0]["gear"]["teeth"] == 30
    for number in (0, 3, True, 1.5):
        assert "stage" in refused(path, number)


def test_the_only_spur_stage_is_taken_with_a_note(xml, save):
    path = save(two_stages(xml, "15"))
    mapping, notes = gear_pair_from_rexs(path)
    assert mapping["gear"]["teeth"] == 30
    assert any("only spur stage" in note for note in notes)
    assert "helix angle 15 deg" in refused(path, 2)


def test_entities_are_refused_before_anything_is_expanded_or_fetched(xml, save, tmp_path):
    secret = tmp_path / "secret.txt"
    secret.write_text("20")
    levels = "".join(f'<!ENTITY l{i} "{f"&l{i - 1};" * 10}">' for i in range(1, 12))
    for declarations in (
        f'<!ENTITY l0 "x">{levels}',
        f'<!ENTITY l11 SYSTEM "{secret.as_uri()}">',
        f'<!ENTITY % outside SYSTEM "{secret.as_uri()}"> %outside;',
    ):
        text = xml().replace("<model ", f"<!DOCTYPE model [{declarations}]>\n<model ")
        text = text.replace(">50.2<", ">&l11;<")
        assert "document type declaration" in refused(save(text))


PART = b"<model version='1.4'><components>%b</components></model>"


@pytest.mark.parametrize(("content", "reason"), [
    (b"", "neither XML nor JSON"),
    (b"no markup", "neither XML nor JSON"),
    (b"<model", "malformed"),
    (b"<html></html>", "root element"),
    (b"<?xml version='1.0' encoding='klingon'?><model version='1.4'/>", "unknown encoding"),
    (b"\xff\xfe<\x00", "malformed"),
    (b"{", "not of the form"),
    (b"{}", "no 'model'"),
    (b'{"model": []}', "not of the form"),
    (b'{"model": {"version": "1.5", "components": 3, "relations": []}}', "not of the form"),
    (b'{"model": {"version": "1.5", "components": [{"id": true}], "relations": []}}', "whole number"),
    (b'{"model": {"version": "1.5", "components": [], "relations": [], "x": NaN}}', "NaN is no number"),
    (b'{"a":' * 100_000, "nested too deeply"),
    (b'{"model": ' + b"9" * 10_000 + b"}", "not of the form"),
    (PART % b"<component id='1.5'/>", "instead of a whole number"),
    (PART % b"<component id='1'/><component id='1'/>", "two components have the id 1"),
    (b"<model><relations><relation type='stage'><ref id='9' role='stage'/></relation></relations></model>",
     "component 9 is referred to"),
    (b"<model version='1.4'>" + b"<a>" * 100 + b"</a>" * 100 + b"</model>", "nested deeper"),
    (b"<model version='1.4'></model>", "no gear stage"),
    (b"PK\x03\x04 broken", "archive cannot be read"),
])  # fmt: skip
def test_broken_files_are_refused_in_one_message_with_the_reason(save, content, reason):
    message = refused(save(content))
    assert message.startswith("REXS file = model.rexs: ")
    assert reason in message


def test_a_file_beyond_the_bound_is_refused(xml, save, monkeypatch):
    path = save(xml())
    monkeypatch.setattr(encodings, "MAX_BYTES", 1000)
    assert "<= 1000 bytes" in refused(path)


def archive(tmp_path, **members):
    path = tmp_path / "model.rexsz"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as made:
        for name, content in members.items():
            made.writestr(name, content)
    return path


def test_a_zip_bomb_is_cut_off(tmp_path, monkeypatch):
    path = archive(tmp_path, **{"model.rexs": b" " * 5_000_000})
    monkeypatch.setattr(encodings, "MAX_BYTES", 1_000_000)
    assert path.stat().st_size < 10_000
    tracemalloc.start()
    assert "more than 1000000 bytes" in refused(path)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 4_000_000  # what is read at most, twice while it grows; the whole would take 5 MB and more


def test_nothing_of_an_archive_is_written(xml, tmp_path):
    path = archive(tmp_path, **{"../model.rexs": xml(), "/etc/evil": "x", "..\\evil": "x"})
    assert gear_pair_from_rexs(path)[0]["pinion"]["teeth"] == 20
    assert [p.name for p in tmp_path.iterdir()] == ["model.rexsz"]


def test_an_archive_holds_exactly_one_model(xml, tmp_path):
    assert "2 models" in refused(archive(tmp_path, **{"a.rexs": xml(), "b.rexsj": "{}"}))
    assert "0 models" in refused(archive(tmp_path, **{"readme.txt": "x"}))
    beside = {"__MACOSX/._a.rexs": b"\0", "a.rexs": xml(), "flanks.gde": ""}
    assert gear_pair_from_rexs(archive(tmp_path, **beside))[0]["pinion"]["teeth"] == 20


def test_encrypted_or_oddly_packed_archives_are_refused(xml, tmp_path):
    data = bytearray(archive(tmp_path, **{"model.rexs": xml()}).read_bytes())
    central = data.rindex(b"PK\x01\x02")
    data[central + 8] |= 1  # general purpose flag, bit 0: encrypted
    path = tmp_path / "locked.rexsz"
    path.write_bytes(data)
    assert "is encrypted" in refused(path)
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_LZMA) as made:
        made.writestr("model.rexs", xml())
    path.write_bytes(stream.getvalue())
    assert "not compressed by 'deflate'" in refused(path)


def test_writing_refuses_what_it_cannot_write(tmp_path):
    for version in ("1.3", "2.0.0", "latest"):
        with pytest.raises(ParameterError, match=r"one of 1\.4"):
            write_rexs("fzg_c", tmp_path / "pair.rexs", version)


@pytest.mark.parametrize("form", [".rexs", ".rexsj"])
def test_damaged_files_are_read_or_refused_but_nothing_else_happens(tmp_path, form):
    seed = 20240501
    dice = random.Random(seed)
    content = write_rexs(lumped.load_gear_pair("nasa_28_28"), tmp_path / f"pair{form}").read_bytes()
    words = b'0 -1 1e308 1e-320 null "" [] NaN \xff \0 < 99999999999'.split(b" ")
    path = tmp_path / f"damaged{form}"
    outcomes = set()
    for _ in range(150):
        data = bytearray(content)
        if dice.random() < 0.5:
            data[dice.randrange(len(data))] = dice.randrange(256)
        else:
            numbers = list(re.finditer(rb'(?<=[>: "])-?\d+(\.\d+)?', content))
            place = dice.choice(numbers)
            data[place.start() : place.end()] = dice.choice(words)
        path.write_bytes(data)
        try:
            gear_pair_from_rexs(path)
            outcomes.add("read")
        except ParameterError:
            outcomes.add("refused")
    assert "refused" in outcomes, seed
    assert "read" in outcomes, seed

"""Does any input do anything but give an answer or one clear refusal?"""

import copy
import math
import pickle
import string

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from lumped import GearPair, geometry, load_gear_pair, preset_names
from lumped.errors import ParameterError
from lumped.schema.files import preset_text
from lumped.schema.pair import field_at
from tests.validation.check.test_descriptions import TEXT as RECORD
from validation.check.curves import Curves
from validation.check.reading.reader import read
from validation.studies import Study, load_study

SECONDS = 10.0
STUDY = """name = "s"
gear_pair = "nasa_28_28"
analysis = "floquet"
outputs = ["spectral_radius", "verdict"]
design = { method = "sobol", samples = 16, seed = 3, sensitivity = true }
settings = { rtol = 1e-9 }
[[axes]]
field = "speed_rpm"
low = 500.0
high = 9000.0
spacing = "log"
[[axes]]
name = "width"
field = ["pinion.face_width", "gear.face_width"]
low = 5.0
high = 9.0
"""


def accepted_or_refused(load, *arguments):
    """The result, or None when it was refused with messages that a person can read."""
    try:
        return load(*arguments)
    except ParameterError as error:
        check_refusal(error)
        return None


def check_refusal(error):
    assert error.problems
    for problem in error.problems:
        assert problem.field
        assert problem.allowed
        assert problem.action
        assert len(str(problem)) < 3000


def check_pair(pair):
    """An accepted pair is finite, exists, and comes back from its own text."""
    if pair is None:
        return
    assert isinstance(pair, GearPair)
    assert all(math.isfinite(value) for value in vars(geometry(pair)).values())
    assert load_gear_pair(pair.to_mapping()) == pair
    hash(pair)


@given(data=st.data())
def test_hostile_mappings(within, hostile_mappings, data):
    mapping = data.draw(hostile_mappings)
    with within(SECONDS):
        check_pair(accepted_or_refused(load_gear_pair, mapping))


@given(data=st.data())
def test_hostile_values_of_one_field(within, hostile_values, data):
    pair = load_gear_pair("nasa_28_28")
    path = data.draw(st.sampled_from(PATHS))
    value = data.draw(hostile_values)
    with within(SECONDS):
        check_pair(accepted_or_refused(pair.with_, {path: value}))


def _paths():
    from lumped.schema.pair import leaf_paths

    return [
        *leaf_paths(load_gear_pair("fzg_c")), "mesh.stiffness", "pinion", "", "..", "a.b.c", "pinion.teeth.x",
    ]  # fmt: skip


PATHS = _paths()


@given(
    path=st.text(max_size=40)
    | st.lists(st.sampled_from([p for q in PATHS for p in q.split(".")])).map(".".join)
)
def test_hostile_paths(within, path):
    with within(SECONDS):
        accepted_or_refused(field_at, path)


#: Well-formed TOML that hardly any key expects, dates among it, which no mapping of a program would hold.
VALUES = [
    *("nan", "-inf", "-1", "0", "1e308", "9" * 400, "0x10", "true", '""', '"x"', '"1e999 mm"', '"/dev/zero"'),
    *("[]", "[[1], [2]]", "[1, 'a']", "{}", "{ a.b = 1 }", "1979-05-27", "07:32:00", "1979-05-27T07:32:00Z"),
]


@st.composite
def broken(draw, texts):
    """A text with a few lines, values, characters or blocks deleted, doubled, swapped or replaced.

    Nine in ten texts with broken characters are no TOML any more; most with other lines and values are.
    """
    text = draw(st.sampled_from(texts))
    whole_lines = draw(st.booleans())
    for _ in range(draw(st.integers(1, 4))):
        if whole_lines:
            lines = text.splitlines(keepends=True) or [""]
            at = draw(st.integers(0, len(lines) - 1))
            key, equals, _ = lines[at].partition("=")
            if equals and draw(st.integers(0, 3)):
                lines[at] = f"{key}= {draw(st.sampled_from(VALUES))}\n"
            else:
                lines[at : at + 2] = draw(
                    st.sampled_from([lines[at + 1 : at + 2], [*lines[at + 1 : at + 2], lines[at]]])
                )
            text = "".join(lines)
            continue
        start = draw(st.integers(0, len(text)))
        end = min(len(text), start + draw(st.sampled_from([0, 1, 1, 2, 5, 20, 200])))
        new = draw(
            st.sampled_from(
                ["", text[start:end] * 2, "=", "[", "]", '"', '"""', "\n", "#", "\x00", "-", "e9", "é"]
            )
            | st.text(alphabet=string.printable, max_size=8)
            | st.sampled_from(["[" * 3000, "{a=" * 3000, "9" * 5000, "a." * 3000, "[[axes]]\n" * 40])
        )
        text = text[:start] + new + text[end:]
    return text


@given(text=broken([preset_text(name) for name in preset_names()]), study=broken([STUDY]))
@settings(max_examples=2 * settings().max_examples)
def test_broken_parameter_and_study_files(within, tmp_path_factory, text, study):
    folder = tmp_path_factory.mktemp("toml")
    for name, broken_text in (("pair.toml", text), ("study.toml", study)):
        (folder / name).write_text(broken_text, encoding="utf-8", errors="surrogatepass", newline="")
    with within(SECONDS):
        check_pair(accepted_or_refused(load_gear_pair, folder / "pair.toml"))
        found = accepted_or_refused(load_study, folder / "study.toml")
    if found is not None:
        assert isinstance(found, Study)
        assert load_study(found.to_toml()) == found


def read_record(path):
    return read(path, load_gear_pair("nasa_28_28"))


#: Dotted keys take the square of their parts to read: these would take hours. Comparing each problem with
#: each other one, or each key with the known ones, would take minutes.
LONG = {
    "a key of many parts": "a" + ".a" * 400_000 + " = 1\n",
    "the same inside": "x = { " + "9." * 300_000 + "9 = 1 }\n",
    "unknown keys": "".join(f"k{number} = 1\n" for number in range(100_000)),
    "unknown keys of a pair": "".join(f"gear_pair.k{number} = 1\n" for number in range(100_000)),
}


@pytest.mark.parametrize("text", LONG.values(), ids=LONG)
def test_very_long_files_are_refused_at_once(within, tmp_path, text):
    (tmp_path / "x.toml").write_text(text)
    for load in (load_gear_pair, load_study, read_record):
        with within(SECONDS):
            assert accepted_or_refused(load, tmp_path / "x.toml") is None


def test_very_many_values_that_are_no_numbers_are_refused_at_once(within):
    text = STUDY.replace("low = 500.0", "values = [" + "true," * 10**6 + "]")
    with within(SECONDS):
        assert accepted_or_refused(load_study, text) is None


@pytest.mark.parametrize("number", ["0x" + "f" * 5000, "1" * 4000, "1" * 5000])
def test_a_number_of_thousands_of_digits_is_refused(tmp_path, number):
    # Python itself refuses to write it out in decimals.
    for text in (STUDY.replace("500.0", number), STUDY.replace("samples = 16", f"samples = {number}")):
        assert accepted_or_refused(load_study, text) is None
    (tmp_path / "x.toml").write_text(preset_text("nasa_28_28").replace("teeth = 28", f"teeth = {number}"))
    assert accepted_or_refused(load_gear_pair, tmp_path / "x.toml") is None


def test_the_mark_that_windows_puts_before_utf_8_is_no_text(tmp_path):
    file = tmp_path / "pair.toml"
    file.write_text(preset_text("fzg_c"), encoding="utf-8-sig")
    assert load_gear_pair(file).name == "fzg_c"
    file.write_text(preset_text("fzg_c"), encoding="utf-16")
    assert accepted_or_refused(load_gear_pair, file) is None


@given(data=st.binary(max_size=300))
def test_bytes_that_are_no_text(within, tmp_path_factory, data):
    file = tmp_path_factory.mktemp("bytes") / "any.toml"
    file.write_bytes(data)
    with within(SECONDS):
        accepted_or_refused(load_gear_pair, file)
        accepted_or_refused(load_study, file)


@given(data=st.data())
def test_hostile_study_mappings(within, hostile_values, data):
    study = load_study(STUDY).to_mapping()
    for _ in range(data.draw(st.integers(1, 3))):
        node = study
        while isinstance(node, (dict, list)) and node:
            keys = sorted(node, key=str) if isinstance(node, dict) else range(len(node))
            key = data.draw(st.sampled_from(list(keys)))
            if not isinstance(node[key], (dict, list)) or data.draw(st.booleans()):
                node[key] = copy.deepcopy(data.draw(hostile_values))  # or the next step changes the pool
                break
            node = node[key]
    with within(SECONDS):
        accepted_or_refused(load_study, study)


CSV = "# measured\nposition [mm], stiffness [N/um]\n8, 60\n10, 75\n14, 90\n18, 76\n22.5, 61\n"


@given(text=broken([CSV]))
@example(text="position [mm], stiffness [N/um]\n" + "1" * 200_000 + ", 2\n")
@example(text="a" + " " * 100_000 + "b, stiffness [N/um]\n1, 2\n")
@example(text='position [mm], stiffness [N/um]\n"' + "\n" * 5)
def test_broken_stiffness_tables(within, tmp_path_factory, text):
    folder = tmp_path_factory.mktemp("csv")
    (folder / "curve.csv").write_text(text, encoding="utf-8", errors="surrogatepass", newline="")
    data = load_gear_pair("nasa_28_28").to_mapping()
    data["mesh"]["stiffness"] = {"model": "table", "file": str(folder / "curve.csv")}
    with within(SECONDS):
        check_pair(accepted_or_refused(load_gear_pair, data))


def test_a_refusal_survives_the_way_between_processes():
    with pytest.raises(ParameterError) as caught:
        load_gear_pair({"name": ""})
    error = pickle.loads(pickle.dumps(caught.value))
    assert (error.problems, error.source, str(error)) == (
        caught.value.problems,
        caught.value.source,
        str(caught.value),
    )


DESCRIPTION = """name = "record"
source = "made up for a test"
data = "record.csv"
delimiter = ";"
decimal = ","
pinion_speed = 800
pinion_torque = "79.1 N*m"
abscissa = { kind = "time", column = "t", unit = "ms" }
[[channel]]
name = "normal"
column = "N A"
quantity = "normal_load"
unit = "N"
pair = "A"
noise = 5.0
"""


@given(description=st.just(DESCRIPTION) | broken([DESCRIPTION]), record=broken([RECORD]))
@example(description=DESCRIPTION, record=RECORD)
@example(description=DESCRIPTION, record="a" + " " * 20_000 + "b;c\n")
@example(description=DESCRIPTION, record='"' + "x" * 200_000 + ";c\n")
def test_broken_records(within, tmp_path_factory, description, record):
    folder = tmp_path_factory.mktemp("record")
    for name, text in (("record.toml", description), ("record.csv", record)):
        (folder / name).write_text(text, encoding="utf-8", errors="surrogatepass", newline="")
    with within(SECONDS):
        curves = accepted_or_refused(read_record, folder / "record.toml")
    assert curves is not None or (description, record) != (DESCRIPTION, RECORD)
    if isinstance(curves, Curves):
        assert np.isfinite(curves.places).all()
        assert all(np.isfinite(channel.values).all() for channel in curves.channels)

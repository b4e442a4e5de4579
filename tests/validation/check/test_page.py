"""Is every example of the page on own files read as it is printed?"""

import re
from pathlib import Path

import numpy as np
import pytest
import scipy.io

import spurcheck
from tests.validation.check.known_curves import PAIR, Known
from validation.check.curves import STATICS
from validation.check.reading.meaning import abscissa_of, understood, value_over_speed
from validation.check.reading.reader import SUFFIXES, read

PAGE = (Path(spurcheck.__file__).parent / "docs/how_to/own_model_files.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"^```(\w+)\n(.*?)^```", PAGE, flags=re.MULTILINE | re.DOTALL)
TABLES = [text for language, text in BLOCKS if language == "text"]
#: Quantities and values of each table of the page, in its order.
READ = (
    {"dte": 18.2e-6, "x_p": -9.1e-6},
    {"dte": 18.2e-6, "bearing_force_x_p": 1480.0},
    {"dte": 18.2e-6, "mesh_force": 1500.0, "theta_p_dot": np.radians(29250.0)},
    {"x_p": -9.1e-6, "theta_p": np.radians(0.017)},
    {"peak_to_peak": 3.1e-6, "rms": 1.0e-6, "order": 1.2e-6},
)


def continued(text):
    """The table with ten rows: the last line again, with an abscissa that grows."""
    *head, last = text.rstrip("\n").split("\n")
    first = re.match(r"\d+(?:[.,]\d+)?", last)[0]
    decimal = "," if "," in first else "."
    start = float(first.replace(",", "."))
    numbers = [f"{start + n * (start or 1e-4):.6f}".replace(".", decimal) for n in range(10)]
    return "\n".join([*head, *(number + last[len(first) :] for number in numbers)])


@pytest.mark.parametrize("number", range(len(READ)))
def test_a_table_of_the_page_is_read(number, tmp_path):
    path = tmp_path / "x.txt"
    path.write_text(continued(TABLES[number]), encoding="utf-8")
    result = read(path, PAIR)
    if number < len(READ) - 1:
        values = {one.quantity: one.values[0] for one in result.channels}
    else:
        values = {one.statistic: one.values[0] for one in result.columns}
    assert values == pytest.approx(READ[number], rel=1e-12)


def test_all_tables_are_tried():
    assert len(TABLES) == len(READ)


def test_the_function_of_the_page_runs():
    (text,) = (text for language, text in BLOCKS if language == "python")
    session = {}
    exec(compile(text, "page", "exec"), session)
    curves = read(session["stage"], PAIR)
    assert {one.quantity for one in curves.channels} == {"mesh_force", "theta_p"}


def test_the_description_of_the_page_is_read(tmp_path):
    (text,) = (text for language, text in BLOCKS if language == "toml")
    (tmp_path / "x.toml").write_text(text)
    known = Known()
    scipy.io.savemat(tmp_path / "out.mat", {"q1": np.degrees(known.turn_p), "q7": 1e6 * known.dte})
    curves = read(tmp_path / "x.toml", PAIR)
    np.testing.assert_allclose(curves.channels[0].values, -known.dte, rtol=1e-13)
    np.testing.assert_allclose(curves.places, known.s, atol=1e-12)


def names_of(start):
    """Names in code style in the middle column of the table whose heading begins so."""
    table = PAGE[PAGE.index(start) :].split("\n\n")[0]
    return [name for line in table.split("\n")[2:] for name in re.findall(r"`([^`]+)`", line.split(" | ")[1])]


def test_every_name_of_the_tables_is_understood():
    quantities = names_of("| quantity |")
    assert len(quantities) > 25
    assert [name for name in quantities if understood(name) is None] == []
    others = names_of("| abscissa |")
    assert len(others) >= 10
    assert [name for name in others if abscissa_of(name) is None] == []
    values = re.findall(r"`([^`]+)`", PAGE[PAGE.index("values over speed:") :].split("\n")[0])
    assert [name for name in values if value_over_speed(name.partition(" [")[0]) is None] == []


def test_every_ending_and_static_is_on_the_page():
    endings = [one for one in SUFFIXES if not one.startswith(".py")]
    assert [one for one in endings if f"`{one}`" not in PAGE] == []
    assert [one for one in STATICS if f"`{one}`" not in PAGE] == []

"""Are numbers written as a reader expects, and without loss of digits?"""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from validation.reporting.blocks import Badge, Quantity, plain
from validation.reporting.chapters.parameters import unit_text
from validation.reporting.formatting import cell, number, prose, quantity

NBSP = "\u00a0"


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0, "0"),
        (3.175, "3.175"),
        (16663.4, "16660"),
        (21000.0, "21000"),
        (-0.25, "\u22120.25"),
        (0.000123, f"1.23{NBSP}×{NBSP}10⁻⁴"),
        (9.99996, "10"),
        (math.nan, "n/a"),
    ],
)
def test_numbers(value, text):
    assert number(value) == text


def test_digits_that_a_number_is_good_to_are_kept():
    assert number(1.1023, 3, measured=True) == "1.10"
    assert quantity(9.296e-6, "m", 3, measured=True).replace(NBSP, " ") == "9.30 µm"
    assert quantity(12.0e-6, "m", 2, measured=True).replace(NBSP, " ") == "12 µm"


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [
        (1.4634e-5, "m", "14.63 µm"),
        (9.9999e-4, "m", "1 mm"),
        (1353.0, "N", "1.353 kN"),
        (8e7, "N/m", "80 MN/m"),
        (56.5, "N m", "56.5 N m"),
        (0.25, "1", "0.25"),
        (0.0, "m", "0"),
        (-2.5e-8, "m", "\u221225 nm"),
    ],
)
def test_quantities_get_prefixes(value, unit, text):
    assert quantity(value, unit).replace(NBSP, " ") == text


@given(st.floats(1e-12, 1e9), st.sampled_from(["m", "N"]))
def test_a_shown_quantity_is_right_to_four_digits(value, unit):
    shown, prefixed = quantity(value, unit).split(NBSP)[0], quantity(value, unit).split(NBSP)[-1]
    factor = {"p": 1e-12, "n": 1e-9, "µ": 1e-6, "m": 1e-3, "": 1.0, "k": 1e3, "M": 1e6, "G": 1e9}[
        prefixed[: -len(unit)]
    ]
    assert float(shown) * factor == pytest.approx(value, rel=5.1e-4)  # half a unit of the fourth digit


def test_cells():
    assert cell(None) == "–"
    assert cell(True) == "yes"
    assert cell(Badge("explained")) == "explained"
    assert plain(Quantity(math.inf, "m")) == {"value": None, "unit": "m"}


@pytest.mark.parametrize(
    ("unit", "text"),
    [("kg*m**2", "kg m²"), ("kg/m**3", "kg/m³"), ("N*m", "N m"), ("mm**2/s", "mm²/s"), ("um", "µm")],
)
def test_units_of_the_parameter_file_are_printed_as_units(unit, text):
    assert unit_text(unit) == text


@pytest.mark.parametrize(
    ("text", "read"),
    [
        ("a shift of 9.43e-03 of a pitch", "a shift of 0.00943 of a pitch"),
        ("at most 1.71e+00, 2.88e-01", "at most 1.71, 0.288"),
        ("rtol 1e-7, error 4.4e-09;", f"rtol 10⁻⁷, error 4.4{NBSP}×{NBSP}10⁻⁹;"),
        ("modulus(206e9, 0.3), 1e3e-05x, v1.2e-05", "modulus(206e9, 0.3), 1e3e-05x, v1.2e-05"),
    ],
)
def test_numbers_inside_a_text_are_written_as_people_do(text, read):
    assert prose(text) == read

"""Does a number at the file boundary become the SI value that its unit says, or a refusal?"""

import math
import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from lumped.errors import ParameterError
from lumped.fields.text_file import read_bytes, read_text
from lumped.fields.units import UNITS, Quantity, to_file, to_si, to_stated

# A correctly rounded conversion is exact to half a unit in the last place of the float it gives.
ULP = 2.0**-52


LBF = 4.4482216152605
TURN = 2 * math.pi
#: One quantity as people write it, all with the same value: unit of the field, SI value, texts.
SPELLINGS = [
    ("N*m", 80.0, "80 Nm|80Nm|80N*m|80 N m|80 N·m|0.08 kNm|8000 Ncm|80000 Nmm|80 Newton meters"),
    ("N*m", 59 * LBF * 0.3048, "59 ft-lbf|59 ft-lb|59 lb-ft|59 lbf ft|59 foot-pounds|59 ft.lbf|59 lbf·ft"),
    ("N*m", 700 * LBF * 0.0254, "700 in-lb|700 lb-in|700 in-lbf|700 lbs in|700 inch-pound|700 lbf*in"),
    ("N*m", 80.0, "80 newton-meters"),
    ("N*m", 8 * 9.80665, "8 kpm|8 kp m|8 kgf m|8 kgf*m"),
    ("rpm", 1450 / 60 * TURN, "1450 rpm|1450rpm|1450 1/min|1450 /min|1450/min|1450 U/min|1450 u/min|1450 Upm"
     "|1450 min-1|1450 min^-1|1450 min⁻¹|1450 RPM|1450 rev/min|1450 r/min|1450 turns/minute|1450 tr/min"),
    ("rpm", 24 * TURN, "24 Hz|0.024 kHz|24 rps|24 rev/s|24 U/s|24 turn/s"),
    ("rpm", 104.7, "104.7 rad/s"),
    ("N/m", 5e8, "5e8 N/m|500 N/um|500 N/µm|500 N/μm|0.5 GN/m|5e5 N/mm|500 MN/m"),
    ("N/m", 1e6 * LBF / 0.0254, "1e6 lb/in|1e6 lbf/inch|1e6 lbs/in"),
    ("N", 5 * LBF, "5 lbf|5 lb|5 lbs|5 pounds"),
    ("mm", 3.175e-3, "3.175 mm|0.125 inch"),
    ("um", 16 * 25.4e-9, "16 microinch"),
    ("GPa", 206e9, "206000 MPa|206000 N/mm2|206000 N/mm²|206000 N/mm^2|206 kN/mm2"),
    ("GPa", 30e6 * LBF / 0.0254**2, "30e6 psi"),
    ("kg", 0.7 * 0.45359237, "0.7 lb"),
    ("kg*m**2", 1.5e-3, "1.5e-3 kg m2|1.5e-3 kgm²|1.5e-3 kgm2|15 kg cm2|15 kgcm²|1500 kg*mm^2"),
    ("kg*m**2", 5 * 0.45359237 * 0.0254**2, "5 lb-in²|5 lb in2|5 lbm in^2"),
    ("kg/m**3", 7850.0, "7.85 g/cm3|7.85 kg/dm³|7850 kg/m3|7850 kg m-3"),
    ("mm**2/s", 220e-6, "220 mm2/s|220 mm²/s|220 cSt"),
    ("mPa*s", 0.01, "10 mPas|10 mPa s|10 mPa·s|10 cP"),
    ("degC", 333.15, "60 °C|60°C|60 C|60 degC|140 F|140 °F|333.15 K"),
    ("degC", 233.15, "-40 degF|-40 degC"),
    ("1/K", 0.002, "0.002 1/K|0.2 %/°C|0.2 %/degC|0.2%/K|0.002 1/degC|0.002/°C|0.002 / C"),
    ("1/K", 0.002, "2e-3 K^-1|0.002 K-1|0.002 K⁻¹"),
    ("1/K", 0.0018, "0.001 1/degF|0.1 %/°F|0.1 %/F"),
    ("deg", math.pi / 9, "20°|20 °|20 deg|20 degrees"),
    ("deg", math.pi / 9, "20º|20 Grad|+20°|1200'|1200 arcmin|72000 arcsec|72000\""),
    ("deg", 0.349, "0.349 rad"),
    ("deg", math.radians(20.5), "20°30'|20° 30′|20 deg 30 arcmin|20°30'0\"|20.5 degrees|1230'"),
    ("deg", math.radians(14.5 + 15.25 / 3600), "14°30'15.25\"|14° 30′ 15.25″|14°30'15.25''"),
    ("deg", -math.radians(5 / 60), "-5'|−5′|-5 arcminutes|-300 arcsec"),
    ("rad", math.radians(30 / 3600), "30\"|30″|30''|30 arcsec|0.5'|30 arcseconds|0'30\""),
    ("um", 5e-6, "5 µm|5 μm|5um|5 micron"),
    ("mm", -3e-3, "-3 mm|−3 mm|–3 mm"),
    ("N*m", 80.0, "80 Newtonmeter|80 newtonmeters"),
    ("rpm", 1450 / 60 * TURN, "1450 r.p.m.|1450 r. p. m"),
    ("1", 0.05, "5 %|5%|0.05|5 percent"),
]  # fmt: skip


@pytest.mark.parametrize(
    ("text", "unit", "si"), [(text, unit, si) for unit, si, texts in SPELLINGS for text in texts.split("|")]
)
def test_a_quantity_as_people_write_it(text, unit, si):
    assert to_si(text, unit) == pytest.approx(si, rel=2 * ULP)


@pytest.mark.parametrize(
    ("text", "unit", "instead"),
    [
        ("1,5 mm", "mm", "a decimal comma: write '1.5 mm'"),
        ("80,5", "N*m", "a decimal comma: write '80.5'"),
        ("1.450,25 rpm", "rpm", "a decimal comma: write '1450.25 rpm'"),
        ("1,450 rpm", "rpm", "write '1.450 rpm' or '1450 rpm'"),
        ("1 450 rpm", "rpm", "leave the gap between the digits out: write '1450 rpm'"),
        ("24 1/s", "rpm", "Write Hz"),  # turns or radians?
    ],
)
def test_a_number_that_can_be_misread_is_explained(text, unit, instead):
    with pytest.raises(ValueError, match=re.escape(instead)):
        to_si(text, unit)


@pytest.mark.parametrize("text", ["20°75'", "20.5°30'", "20°30.5'15\"", "1'60\""])
def test_an_angle_whose_parts_do_not_fit_is_refused(text):
    with pytest.raises(ValueError, match="minutes and seconds are below 60"):
        to_si(text, "deg")


def test_marks_of_minutes_belong_to_angles():
    for text in ("5'", '30"'):
        with pytest.raises(ValueError, match="has the character"):
            to_si(text, "mm")


def test_a_kinematic_viscosity_says_what_to_write():
    with pytest.raises(ValueError, match=r"iso_vg = '46 cSt'.*'40.02 mPa\*s' for 870 kg/m\^3"):
        to_si("46 cSt", "mPa*s")


def test_a_string_with_the_stated_unit_is_the_bare_number():
    for unit in UNITS:
        for number in (3.175, 0.1, 88.9, 4875.0, 1e-3):
            text = f"{number!r}" if unit == "1" else f"{number!r} {unit}"
            assert to_si(text, unit) == to_si(number, unit), text


@pytest.mark.parametrize("unit", [unit for unit in UNITS if unit not in ("1", "degC")])
def test_a_unit_of_files_gives_the_bits_of_the_unit_parser(unit):
    """Text with a sign of multiplication is read by pint, text with a blank without pint."""
    for named in (name for name in UNITS if UNITS[name].si == UNITS[unit].si):
        for number in ("1", "0.1", "-3.175", "2.7e-5", "88.9", "1e3", "123456.789"):
            assert to_si(f"{number} {named}", unit) == to_si(f"{number}*{named}", unit), named


@pytest.mark.parametrize("number", ["70", "-0.1", "36.6", "1e2"])
def test_a_temperature_has_the_bits_of_the_unit_parser(number):
    assert to_si(f"{number} degC", "degC") == to_si(f"{number} °C", "degC")


@pytest.mark.parametrize("number", ["0.1", "-7.3", "33.333333333333333333", "1e-3", "12.5"])
def test_per_cent_has_the_bits_of_the_unit_parser(number):
    """Text with a sign of multiplication is read by pint."""
    assert to_si(f"{number}%", "1") == to_si(f"{number} %", "1") == to_si(f"{number}*percent", "1")


def test_a_unit_of_files_needs_no_unit_parser(monkeypatch):
    monkeypatch.setattr("lumped.fields.units._registry", None)
    assert to_si("20 mm", "um") == 0.02
    assert to_si("70 degC", "degC") == 343.15
    assert to_si(" -2e3 N*m", "N*m") == -2000.0
    assert to_si("0.1 %", "1") == 0.001
    with pytest.raises(TypeError, match="not callable"):
        to_si("20 inch", "mm")


@pytest.mark.parametrize("unit", UNITS)
def test_example_of_every_unit_is_accepted(unit):
    assert math.isfinite(to_si(UNITS[unit].example, unit))


#: Without unit, without number, of another kind, code, what would never end, and what may not vanish.
NO_QUANTITY = {
    "mm": ["3.175", "mm", "", "5 kg", "80 lb", "3 parsnips", "__import__('os')", "mm; import os",
     "9**9**9**9 mm", "10**400 mm", "1/0 mm", "((((((((((", "\x00", "😀 mm", "2 😀 mm",
     "2 ? mm", "1 mm " + "* 1" * 100],
    "1": ["", "   ", "10 mm"], "N*m": ["200 lbf", "5 lb"], "deg": ["20 percent", "3 count", "5 sr"],
}  # fmt: skip


@pytest.mark.parametrize(("text", "unit"), [(t, unit) for unit, texts in NO_QUANTITY.items() for t in texts])
def test_text_that_is_no_such_quantity_is_refused_with_an_example(text, unit):
    with pytest.raises(ValueError, match=r"string such as|without a unit"):
        to_si(text, unit)


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf, "nan mm", "inf mm", "1e400 mm", 10**400])
def test_not_finite_is_refused(value):
    with pytest.raises(ParameterError):
        Quantity("mm", above=0).parse(value)


@pytest.mark.parametrize("value", [True, False, None, [1.0], {"value": 1}, 1j, b"1 mm"])
def test_other_types_are_refused(value):
    with pytest.raises(ParameterError, match="Give a number"):
        Quantity("mm").parse(value)


@pytest.mark.parametrize("unit", UNITS)
@pytest.mark.parametrize("bound", [0.3, 10, 35, 180, 1000, 200000])
def test_a_closed_bound_admits_itself(unit, bound):
    # Angles and speeds come back from SI off by a rounding: the comparison must not notice.
    assert Quantity(unit, at_least=bound).parse(bound) == to_si(bound, unit)
    assert Quantity(unit, at_most=bound).parse(bound) == to_si(bound, unit)
    for open_bound in ({"above": bound}, {"below": bound}):
        with pytest.raises(ParameterError):
            Quantity(unit, **open_bound).parse(bound)


def test_a_bound_is_kept_in_any_unit():
    limit = Quantity("mm", above=0, at_most=25.4)
    assert limit.parse("1 inch") == pytest.approx(0.0254, rel=ULP)
    with pytest.raises(ParameterError, match=r"allowed > 0 mm and <= 25.4 mm"):
        limit.parse("1.001 inch")
    with pytest.raises(ParameterError, match=r"-1 inch"):
        limit.parse("-1 inch")


@pytest.mark.parametrize("unit", UNITS)
@given(value=st.floats(min_value=1e-300, max_value=1e300))
def test_writing_and_reading_keeps_every_bit(unit, value):
    text = to_file(value, unit)
    assert to_si(text, unit) == value


@pytest.mark.parametrize("unit", UNITS)
@given(stated=st.floats(min_value=1e-6, max_value=1e9))
def test_stated_value_is_shown_as_it_was_given(unit, stated):
    # Offset units lose the digits that the offset swallows: 273.15 against 1e-6 leaves 5e-14 absolute.
    assert to_stated(to_si(stated, unit), unit) == pytest.approx(stated, rel=4 * ULP, abs=1e-13)


@given(stated=st.floats(min_value=1e-6, max_value=1e9).map(lambda value: float(f"{value:.12g}")))
def test_a_number_of_few_digits_reads_back_in_its_own_digits(stated):
    """Not 2999.9999999999998 rpm for 3000, nor its rad/s in a file."""
    assert to_stated(to_si(stated, "rpm"), "rpm") == to_file(to_si(stated, "rpm"), "rpm") == stated


@pytest.mark.parametrize(("make", "words"), [
    (lambda path: None, "that exists"),
    (lambda path: path.mkdir(), "folder or a device"),
    (lambda path: path.symlink_to(path), "levels of symbolic links"),
    (lambda path: path.symlink_to("/dev/zero"), "folder or a device"),
    (lambda path: path.write_bytes(b"a = 'caf\xe9'"), "byte 8 is no UTF-8"),
    (lambda path: path.write_bytes(b"x" * 11), "<= 10 bytes"),
])  # fmt: skip
def test_files_that_are_no_text_say_why(tmp_path, make, words):
    make(tmp_path / "file")
    with pytest.raises(ParameterError, match=words) as caught:
        read_text(tmp_path / "file", 10 if "10 bytes" in words else 100, field="data", kind="CSV file")
    assert caught.value.problems[0].field == "data"
    assert str(tmp_path / "file") in caught.value.problems[0].value


@pytest.mark.parametrize(
    ("name", "words"), [("a\0b", "cannot be read: embedded null byte"), ("a" * 5000, "name too long")]
)
def test_names_that_no_file_can_have(name, words):
    with pytest.raises(ParameterError, match=words):
        read_bytes(name, 10)

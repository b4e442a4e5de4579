"""Units at the file boundary: a number has the field's stated unit, a string names a unit; SI inside."""

from __future__ import annotations

import math
import operator
import re
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from decimal import Decimal, DivisionByZero, InvalidOperation, Overflow
from functools import cache, cached_property, lru_cache
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from pydantic_core import core_schema

from lumped.errors import ParameterError, refuse, shown

if TYPE_CHECKING:
    import pint
    from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
    from pydantic.json_schema import JsonSchemaValue


Rewriting = tuple[re.Pattern[str], str | Callable[[re.Match[str]], str]]

_WORD = "A-Za-zµμ"
#: Spellings of any quantity, rewritten one after the other.
_EVERYWHERE: tuple[Rewriting, ...] = (
    (re.compile(r"[·⋅×]"), "*"),
    (re.compile(r"[−–](?=[\d.])"), "-"),  # signs as word processors set them
    (re.compile(r"\b[A-Z][a-z]{4,}"), lambda found: found[0].lower()),  # Newton, Meter
    (re.compile(r"\bnewtonmeters?\b"), "newton_meter"),
    # A power written small, raised or not at all: min-1, mm2, N m s^-1; the e of 1e-3 follows a digit.
    (re.compile(rf"(?<![\w.])([{_WORD}]+)(-?[1-4])(?![\w.])"), r"\1^\2"),
    (re.compile(rf"(?<=[{_WORD}²³])-(?=[{_WORD}])"), "*"),  # ft-lbf, newton-meters
    (re.compile(r"\bkg(c?m)(?=\^|²)"), r"kg*\1"),
    (re.compile(r"%"), " percent"),
)
_POUND_FORCE = (
    (re.compile(r"(?<![A-Za-z])(lbs?|pounds?)\b"), "lbf"),
    (re.compile(r"(?<![A-Za-z])kp(?![a-z])"), "kgf"),
    (re.compile(r"(?<![A-Za-z])kpm\b"), "kgf*m"),
)
_TURNS = (
    (re.compile(r"(?<=[\d.])\s+1\s*/\s*min\b"), " rpm"),
    (re.compile(r"(?:\b(?:rev|revs|r|tr|turns?)|(?<![A-Za-z])[Uu])?\s*/\s*min(ute)?\b"), " rpm"),
    (re.compile(r"(?i:\br\.\s?p\.\s?m\.?)"), "rpm"),
    (re.compile(r"\bmin\^-1|\bmin⁻¹|(?i:(?<![a-z])(rpm|upm)\b)"), "rpm"),
    (re.compile(r"(?<![A-Za-z])(?:rev|revs|r|tr|U)?\s*/\s*s(ec)?\b(?<=[a-zU]/s)"), " rps"),
    (re.compile(r"(?<![A-Za-z])(k?)Hz\b"), r"\1rps"),
)
#: Stated unit -> spellings with a special meaning in a quantity of this unit: a pound is a force in a torque.
_WHERE: dict[str, tuple[Rewriting, ...]] = {
    "N*m": _POUND_FORCE,
    "N": _POUND_FORCE,
    "N/m": _POUND_FORCE,
    "rpm": _TURNS,
    "degC": ((re.compile(r"(?<=[\d.])\s*[°º]?\s*([CF])\s*$"), r" deg\1"),),
    # A degree is a difference of temperatures here; pint would count degrees Celsius from absolute zero.
    "1/K": (
        (re.compile(r"/\s*(?:°\s*C|º\s*C|deg\s*C|degC|C|kelvin)\s*$"), "/ K"),
        (re.compile(r"/\s*(?:°\s*F|º\s*F|deg\s*F|degF|F)\s*$"), "/ delta_degF"),
        (re.compile(r"(?<=[\d.])\s*K(?:\^-1|⁻¹)\s*$"), " 1/K"),
    ),
}
#: Units that pint lacks, in the notation of pint. Prefixes work with these units too.
DEFINITIONS = (
    "newton_meter = newton * meter = Nm",
    "newton_millimeter = newton * millimeter = Nmm",
    "newton_centimeter = newton * centimeter = Ncm",
    "pascal_second = pascal * second = Pas",
    "@alias pound = lbm",
)
_GAP = re.compile(r"(?<=\d)\s+(?=\d{3}(?!\d))")
_COMMA = re.compile(r"\s*([+-]?[\d.]*\d),(\d+)(?=$|[^\d,])")


def about_digits(text: str) -> str:
    """Return what to write instead of a number with a comma or with gaps; empty for any other text."""
    if _GAP.search(text):  # pint would multiply the parts
        return f"leave the gap between the digits out: write '{_GAP.sub('', text)}'"
    result = _COMMA.match(text)
    if result is None:
        return "write decimals with a point" if "," in text else ""
    before_comma, decimals = result.groups()
    integer = before_comma.replace(".", "")
    rest = text[result.end() :]
    if len(decimals) == 3 and "." not in before_comma:
        return (
            f"the comma may be a decimal comma or part thousands: write '{integer}.{decimals}{rest}' or "
            f"'{integer}{decimals}{rest}'"
        )
    return f"this is a decimal comma: write '{integer}.{decimals}{rest}'"


class StatedUnit(NamedTuple):
    """A unit of numbers in files.

    Attributes
    ----------
    si : SI unit
    factor : factor to SI
    meaning : the kind of quantity
    example : a string with another unit of this kind
    """

    si: str
    factor: Decimal
    meaning: str
    example: str


_PI = Decimal("3.14159265358979323846264338327950288")
#: Stated unit in files -> the unit.
UNITS: dict[str, StatedUnit] = {
    "1": StatedUnit("1", Decimal(1), "a pure number", "0.05"),
    "mm": StatedUnit("m", Decimal("1e-3"), "a length", "0.125 inch"),
    "um": StatedUnit("m", Decimal("1e-6"), "a length", "16 microinch"),
    "1/mm": StatedUnit("1/m", Decimal("1e3"), "an inverse length", "500 1/inch"),
    "deg": StatedUnit("rad", _PI / 180, "an angle", "0.349 rad"),
    "rpm": StatedUnit("rad/s", _PI / 30, "a rotational speed", "104.7 rad/s"),
    "N*m": StatedUnit("N*m", Decimal(1), "a torque", "200 lbf*in"),
    "kW": StatedUnit("W", Decimal("1e3"), "a power", "6.7 hp"),
    "kg": StatedUnit("kg", Decimal(1), "a mass", "0.7 lb"),
    "kg*m**2": StatedUnit("kg*m**2", Decimal(1), "a moment of inertia", "1.05 lb*inch**2"),
    "kg/m**3": StatedUnit("kg/m**3", Decimal(1), "a density", "7.85 g/cm**3"),
    "GPa": StatedUnit("Pa", Decimal("1e9"), "a pressure", "30e6 psi"),
    "N/m": StatedUnit("N/m", Decimal(1), "a stiffness", "571000 lbf/inch"),
    "N/mm": StatedUnit("N/m", Decimal("1e3"), "a load per length", "600 lbf/inch"),
    "N*m/rad": StatedUnit("N*m/rad", Decimal(1), "a torsional stiffness", "150 N*m/deg"),
    "N*s/m": StatedUnit("N*s/m", Decimal(1), "a damping", "2 lbf*s/inch"),
    "N*m*s/rad": StatedUnit("N*m*s/rad", Decimal(1), "a torsional damping", "0.5 N*m*s/deg"),
    "mPa*s": StatedUnit("Pa*s", Decimal("1e-3"), "a dynamic viscosity", "10 cP"),
    "mm**2/s": StatedUnit("m**2/s", Decimal("1e-6"), "a kinematic viscosity", "32 cSt"),
    "degC": StatedUnit("K", Decimal(1), "a temperature", "140 degF"),
    "1/K": StatedUnit("1/K", Decimal(1), "a change per degree of temperature", "0.2 %/degC"),
    "mm/s": StatedUnit("m/s", Decimal("1e-3"), "a velocity", "0.1 inch/s"),
    "m/s**2": StatedUnit("m/s**2", Decimal(1), "an acceleration", "50 mm/s**2"),
    "rad/s**2": StatedUnit("rad/s**2", Decimal(1), "an angular acceleration", "2 deg/s**2"),
    "N": StatedUnit("N", Decimal(1), "a force", "5 lbf"),
    "m": StatedUnit("m", Decimal(1), "a length", "3 um"),
    "s": StatedUnit("s", Decimal(1), "a time", "2 ms"),
    "rad": StatedUnit("rad", Decimal(1), "an angle", "20 deg"),
    "Hz": StatedUnit("Hz", Decimal(1), "a frequency", "50 kHz"),
}
_ZERO_CELSIUS = Decimal("273.15")
_PERCENT = Decimal("0.01")
_NUMBER = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*")
_NOT_IN_QUANTITY = re.compile(r"[^\w\s.+\-−–*/^()°º%²³⁻¹·⋅×]|%%")
_PART = r"(?:(\d+\.?\d*|\.\d+)\s*(?:{})\s*)?"
#: Degrees, minutes and seconds of arc, each once at most: 20°30', 5', 30", 20 deg 30 arcmin.
_ANGLE = re.compile(
    r"\s*([-+−–]?)\s*"
    + _PART.format(r"°|º|deg(?:rees?)?\b|Grad\b")
    + _PART.format(r"['′’](?!['′’])|arc\s?min(?:utes?)?\b")
    + _PART.format(r"[\"″”]|''|′′|’’|arc\s?sec(?:onds?)?\b")
)


def _in_degrees(text: str) -> str:
    """An angle in degrees, minutes and seconds of arc, as degrees. Text of another form is unchanged."""
    match = _ANGLE.fullmatch(text)
    groups: tuple[Any, ...] = (None, None, None, None) if match is None else match.groups()
    sign, *parts = groups  # degrees, minutes, seconds
    stated = [place for place, part in enumerate(parts) if part is not None]
    if not stated or stated == [0]:
        return re.sub(r"(?<=\d)\s*(?:º|Grad\b)", " deg", text)
    without_decimals = all("." not in parts[place] for place in stated[:-1])
    below_sixty = all(Decimal(parts[place]) < 60 for place in stated[1:])
    if not (without_decimals and below_sixty):
        raise ValueError(
            f"'{text}' is no angle: beside a larger part, minutes and seconds are below 60, and the last "
            "part alone has decimals; write degrees: '20.5 deg'"
        )
    sixtieths = zip(parts, (1, 60, 3600), strict=True)
    angle = sum((Decimal(part) / part_of for part, part_of in sixtieths if part is not None), Decimal(0))
    return f"{'-' if sign in ('-', '−', '–') else ''}{angle:f} deg"


class SIValue(float):
    """A number in SI with the unit, the value of a field. A field takes such a number back unchanged.

    In a formula the number is a float, and the result of a formula is a bare number.
    """

    __slots__ = ("unit",)
    unit: str

    def __new__(cls, value: float, unit: str) -> SIValue:
        """Make the value of a number in ``unit``."""
        made = super().__new__(cls, value)
        made.unit = unit
        return made

    def to(self, unit: str) -> float:
        """Return the bare number in another unit: ``pair.operating.pinion_speed.to("rpm")``."""
        stated = next(name for name, one in UNITS.items() if one.si == self.unit)
        try:
            zero, one = (to_si(f"{number} {unit}", stated) for number in (0, 1))
        except ValueError as error:
            raise refuse("unit", shown(unit), f"a unit that {self.unit} converts to", f"{error}.") from None
        if unit in UNITS and UNITS[unit].si == self.unit:
            return to_stated(self, unit)  # exact
        return (self - zero) / (one - zero)

    def __getnewargs__(self) -> tuple[float, str]:  # type: ignore[override]
        """Copy and pickle with the unit."""
        return float(self), self.unit

    def __repr__(self) -> str:
        """Return text that a field takes."""
        return f"{float(self)!r} {self.unit}"

    __str__ = float.__repr__


@cache
def _registry() -> pint.UnitRegistry[Decimal]:
    # Decimal arithmetic makes "3.175 mm" and 3.175 the same float, correctly rounded once.
    import pint

    registry: pint.UnitRegistry[Decimal] = pint.UnitRegistry(
        non_int_type=Decimal, autoconvert_offset_to_baseunit=True
    )
    for definition in DEFINITIONS:
        registry.define(definition)
    return registry


@lru_cache(maxsize=4096)  # variations of a pair have most numbers in common
def _number_to_si(text: str, unit: str) -> float:
    number = Decimal(text)
    if not number.is_finite():
        return float(text)
    return float(number + _ZERO_CELSIUS if unit == "degC" else number * UNITS[unit].factor)


def _in_unit_of_files(text: str, unit: str) -> float | None:
    """Convert a number with a unit of ``UNITS``, or per cent, to SI. Without pint: it takes long to import.

    None: the text is anything else, or has no finite value.
    """
    match = _NUMBER.match(text)
    if match is None:
        return None
    named = text[match.end() :]
    with suppress(Overflow):
        if named == "%" and unit == "1":
            number = float(Decimal(match[1]) * _PERCENT)
        elif named != "1" and named in UNITS and UNITS[named].si == UNITS[unit].si:
            number = _number_to_si(match[1], named)
        else:
            return None
        return number if math.isfinite(number) else None
    return None


def to_si(value: float | str, unit: str) -> float:
    """Convert a number in the stated unit, or text with a unit, to SI.

    Raises ValueError with what is wrong and what to write.
    """
    si, _, meaning, example = UNITS[unit]
    advice = f"write a number (read as {unit}) or a string such as '{example}'"
    if isinstance(value, SIValue):
        if value.unit != si:
            raise ValueError(f"{value!r} is not {meaning}; {advice}")
        return float(value)
    if not isinstance(value, str):
        return _number_to_si(repr(float(value)), unit)
    if len(value) > 80:
        raise ValueError(f"text of {len(value)} characters is no quantity; {advice}")
    number = _in_unit_of_files(value, unit)
    if number is not None:
        return number
    # The unit parser drops what it does not know: it would read 1,5 as 15.
    text = _in_degrees(value) if si == "rad" else value
    if odd := _NOT_IN_QUANTITY.search(text):
        raise ValueError(f"{value!r} has the character {odd[0]!r}; {about_digits(value) or advice}")
    if gap := about_digits(value):
        raise ValueError(f"{value!r}: {gap}")
    if not any(character.isdigit() for character in value):
        raise ValueError(f"'{value}' has no number; {advice}")
    # Into pint's grammar; "lb" is a force where the stated unit is a torque, else a mass.
    for pattern, instead in (*_EVERYWHERE, *_WHERE.get(unit, ())):
        text = pattern.sub(instead, text)
    registry = _registry()
    try:
        quantity: pint.Quantity[Decimal] = registry.Quantity(text)
    except (InvalidOperation, Overflow, DivisionByZero):
        raise ValueError(f"'{value}' is no finite quantity; {advice}") from None
    except Exception as error:  # noqa: BLE001  (pint lets tokenizer, attribute and arithmetic errors through)
        unknown = " and ".join(f"'{name}'" for name in getattr(error, "unit_names", ()))
        why = f"has the unknown unit {unknown}" if unknown else "is no quantity"
        raise ValueError(f"'{value}' {why}; {advice}") from None
    if unit != "1" and quantity.unitless:
        raise ValueError(f"'{value}' has no unit; {advice}")
    if unit == "1" and not quantity.unitless:
        raise ValueError(f"'{value}' is not a pure number; write it without a unit")
    try:
        # Comparing base units rather than dimensions keeps the radian: 50 Hz is not 50 rad/s.
        if quantity.to_root_units().units != registry.Quantity(1, si).to_root_units().units:
            if unit == "rpm" and quantity.check("1/[time]"):
                advice = "turns or radians? Write Hz (turns a second), rpm or rad/s"
            if unit == "mPa*s" and quantity.check("[length]**2/[time]"):
                advice = _about_kinematic(value, 1e6 * float(quantity.to("m**2/s").magnitude))
            raise ValueError(f"'{value}' is not {meaning}; {advice}")
        result = float(quantity.to(si).magnitude)
    except (InvalidOperation, Overflow, OverflowError):
        result = math.nan
    if not math.isfinite(result):
        raise ValueError(f"'{value}' is no finite quantity; {advice}")
    return result


def _about_kinematic(text: str, viscosity: float) -> str:
    """What to write instead of a kinematic viscosity [mm^2/s] in a field for a dynamic viscosity."""
    return (
        "it is a kinematic viscosity. Where it is the oil's at 40 degC, as on a data sheet, write instead of "
        f"viscosity: viscosity_law = {{ iso_vg = '{text}', temperature = 70 }}, with your oil temperature. "
        "Where it holds at the contact inlet, write it times the density there: "
        f"'{viscosity * 0.87:.4g} mPa*s' for 870 kg/m^3"
    )


def to_file(value: float, unit: str) -> float | str:
    """Write an SI number so that reading gives the same bits.

    The number is in the stated unit if the conversion is exact, otherwise text in the SI unit.
    """
    stated = to_stated(value, unit)
    return stated if to_si(stated, unit) == value else f"{float(value)!r} {UNITS[unit].si}"


def to_stated(value: float, unit: str) -> float:
    """Convert an SI number to the field's stated unit: the shortest number that reads as the SI number."""
    return _stated(repr(float(value)), unit)


@lru_cache(maxsize=4096)
def _stated(text: str, unit: str) -> float:
    number = Decimal(text)
    stated = number - _ZERO_CELSIUS if unit == "degC" else number / UNITS[unit].factor
    short = float(f"{stated:.15g}")  # 3000 rpm, not 2999.9999999999998
    return short if to_si(short, unit) == float(text) else float(stated)


@dataclass(frozen=True)
class Quantity:
    """Annotation of a float field: stated unit and allowed range, as a user writes both.

    A refusal of a quantity names no field; pydantic adds the place.

    Attributes
    ----------
    unit : stated unit of a bare number, a key of ``UNITS``
    above, below : open bounds in this unit
    at_least, at_most : closed bounds in this unit
    optional : whether None (in a file: leaving the key out) is a value
    word : text that is a value too
    action : what to do when the value is refused
    """

    unit: str
    above: float | None = None
    at_least: float | None = None
    below: float | None = None
    at_most: float | None = None
    optional: bool = False
    word: str = ""
    action: str = "Correct the value or its unit."

    @property
    def allowed(self) -> str:
        """The allowed range as text, with the unit."""
        unit = "" if self.unit == "1" else f" {self.unit}"
        parts = (f"{sign} {bound:g}{unit}" for sign, _, bound, _ in self._bounds)
        allowed = " and ".join(parts) or f"any finite number{unit}"
        return f"{allowed} or {self.word!r}" if self.word else allowed

    @property
    def _bounds(self) -> list[tuple[str, str, float, Callable[[float, float], bool]]]:
        """Sign, key of JSON Schema, value and comparison of each bound of the quantity."""
        every = (
            (">", "exclusiveMinimum", self.above, operator.gt),
            (">=", "minimum", self.at_least, operator.ge),
            ("<", "exclusiveMaximum", self.below, operator.lt),
            ("<=", "maximum", self.at_most, operator.le),
        )
        return [(sign, key, bound, holds) for sign, key, bound, holds in every if bound is not None]

    @cached_property
    def _limits(self) -> list[tuple[Callable[[float, float], bool], float]]:
        """Comparison and bound in SI of each bound.

        Bounds are converted like values: a value at a bound equals the bound bit for bit.
        """
        return [(holds, to_si(bound, self.unit)) for _, _, bound, holds in self._bounds]

    def _refusal(self, value: str, action: str) -> ParameterError:
        return refuse("", value, self.allowed, action)

    def parse(self, value: object) -> Any:
        """Convert a number, text with a unit or an `SIValue` to SI, or refuse the value."""
        if (value is None and self.optional) or (isinstance(value, str) and value == self.word != ""):
            return value
        if isinstance(value, np.generic):
            value = value.item()
        if isinstance(value, bool) or not isinstance(value, (int, float, str)):
            raise self._refusal(shown(value), "Give a number or a string with a unit.")
        try:
            si = to_si(value, self.unit)
        except (ValueError, OverflowError) as error:
            action = str(error)
            raise self._refusal(shown(repr(value)), action[:1].upper() + action[1:] + ".") from None
        finite = math.isfinite(si)
        if not finite or not all(holds(si, limit) for holds, limit in self._limits):
            bare = not isinstance(value, (str, SIValue))
            text = f"{value!r} {self.unit}".removesuffix(" 1") if bare else shown(value)
            raise self._refusal(text, self.action if finite else "Give a finite number.")
        return si if self.unit == "1" else SIValue(si, UNITS[self.unit].si)

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> core_schema.CoreSchema:
        return core_schema.no_info_plain_validator_function(self.parse)

    def __get_pydantic_json_schema__(
        self, schema: core_schema.CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        return self.json_schema()

    def json_schema(self) -> JsonSchemaValue:
        """JSON Schema of the quantity: a number in the stated unit with its bounds, or text with a unit."""
        number = {"type": "number"} | {key: bound for _, key, bound, _ in self._bounds}
        text = {"type": "string", "examples": [UNITS[self.unit].example]}
        return {"anyOf": [number, text], "unit": self.unit, "si_unit": UNITS[self.unit].si}


class QuantityRange(Quantity):
    """Annotation of a field that holds the lower and the upper end of a range of quantities, or None."""

    @property
    def allowed(self) -> str:
        """The allowed ranges as text."""
        return f"two increasing values FROM..TO, each {super().allowed}"

    def parse(self, value: object) -> tuple[float, float] | None:
        """Convert two ends, or text FROM..TO, to SI, or refuse the value."""
        if value is None:
            return None
        ends = _ends(value) if isinstance(value, str) else value
        if not isinstance(ends, (list, tuple)) or len(ends) != 2:
            raise self._refusal(shown(value), self.action)
        low = super().parse(ends[0])
        high = super().parse(ends[1])
        if low >= high:
            raise self._refusal(shown(value), self.action)
        return low, high

    def json_schema(self) -> JsonSchemaValue:
        """Two ends, or text."""
        ends = {"type": "array", "items": super().json_schema(), "minItems": 2, "maxItems": 2}
        text = {"type": "string", "examples": ["200..3000"]}
        return {"anyOf": [ends, text], "unit": self.unit, "si_unit": UNITS[self.unit].si}


class QuantityList(Quantity):
    """Annotation of a field that holds a list of quantities, or None."""

    @property
    def allowed(self) -> str:
        """The allowed range of each value as text."""
        return f"a list of values, each {super().allowed}"

    def parse(self, value: object) -> tuple[float, ...] | None:
        """Convert a list of numbers or text with units to SI, or refuse the list."""
        if value is None:
            return None
        if isinstance(value, np.ndarray):
            value = value.tolist()
        if not isinstance(value, (list, tuple)) or not value:
            raise self._refusal(shown(value), "Give a list: [0.0, 1.2].")
        return tuple(super(QuantityList, self).parse(one) for one in value)

    def json_schema(self) -> JsonSchemaValue:
        """A list of numbers."""
        items = {"type": "array", "items": super().json_schema(), "minItems": 1}
        return items | {"unit": self.unit, "si_unit": UNITS[self.unit].si}


def _ends(text: str) -> list[float | str]:
    """Ends of "FROM..TO", bare numbers as numbers.

    A first end without a unit has the unit of the second end.
    """
    if text.count("..") != 1:
        return []
    low, high = text.split("..")
    number = _NUMBER.match(high)
    unit = high[number.end() :] if number else ""
    if _NUMBER.fullmatch(low):
        low = f"{low.strip()} {unit}"
    return [float(end) if _NUMBER.fullmatch(end) else end.strip() for end in (low, high)]

"""What a name means: a quantity with its gear, axis and derivative, an abscissa, a value over speed."""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterable, Iterator
from functools import lru_cache
from typing import Literal, NamedTuple

from validation.check.quantities import PAIR_LABELS, QUANTITIES
from validation.check.reading.headings import Heading, readings, words_of

Statistic = Literal["peak_to_peak", "rms", "mean", "order"]
#: Kinds of abscissa in the order in which one is chosen.
AbscissaKind = Literal["time", "order", "mesh_phase", "pinion_angle", "gear_angle", "speed", "gear_speed"]
#: Part of a complex amplitude over the order.
Part = Literal["amplitude", "phase", "real", "imag"]


class Meaning(NamedTuple):
    """Meaning of the words of a heading.

    Attributes
    ----------
    quantity : name in ``QUANTITIES``
    tooth_pair : label of the tooth pair; None: the quantity is that of the mesh
    assumption : sentence on what the words leave open; empty: nothing
    """

    quantity: str
    tooth_pair: str | None = None
    assumption: str = ""


_GEAR_WORDS = {
    **dict.fromkeys(("p", "pinion", "1", "ritzel", "driver", "driving", "input", "antrieb"), "p"),
    **dict.fromkeys(("g", "2", "wheel", "driven", "output", "abtrieb"), "g"),
}
#: "Rad" is the gear where a German word stands beside it; else it is a unit.
_GERMAN = {
    "drehzahl", "drehwinkel", "winkel", "lagerkraft", "verschiebung", "weg", "geschwindigkeit",
    "beschleunigung",
    "winkelgeschwindigkeit", "verdrehung", "zahnmoment", "eingriffsmoment",
}  # fmt: skip
_NUMBERS = ("1", "2")
_AXIS_WORDS = {"x": "x", "loa": "x", "y": "y", "oloa": "y"}
#: Phrases that become one word before the words are split.
_PHRASES = (
    (re.compile(r"(off|across|(normal|perpendicular) to)[ _-]*(the )?[ _-]*line[ _-]of[ _-]action", re.I),
     "oloa"),
    (re.compile(r"(along[ _-]*(the )?)?[ _-]*line[ _-]of[ _-]action", re.I), "loa"),
    (re.compile(r"d\s*/\s*dt", re.I), "dot"),
    (re.compile(r"transmission[ _-]*error", re.I), "te"),
    (re.compile(r"\brev(olutions)?[ _/-]*min\b", re.I), "rpm"),
)  # fmt: skip
_FILLERS = {
    "the", "of", "on", "in", "at", "der", "des", "am", "im", "dynamic", "dyn", "total", "sum",
    "all", "pairs", "dynamische", "dynamischer", "cm", "mea", "along", "rotational", "center",
    "centre",
}  # fmt: skip
_RATES = {
    **dict.fromkeys(("dot", "rate", "velocity", "vel", "speed", "geschwindigkeit", "v"), 1),
    **dict.fromkeys(("ddot", "acceleration", "accel", "acc", "accelerometer", "beschleunigung"), 2),
}
#: Words that are a rate of a rotation without the word of a rotation.
_SPEEDS = {"omega", "rpm", "drehzahl", "winkelgeschwindigkeit", "n"}
_ROTATIONS = {
    "theta", "phi", "th", "rotation", "angle", "winkel", "drehwinkel", "rotationangle", "angular", "rot",
    "angulardisplacement", "angularposition", "angulardeviation", "angledeviation", "verdrehung", "torsion",
}  # fmt: skip
_DISPLACEMENTS = {
    "", "displacement", "disp", "u", "verschiebung", "weg", "position", "pos", "translation", "shaft",
    "shaftdisplacement", "d",
}  # fmt: skip
_BEARING_FORCES = {
    "bearingforce", "brgforce", "lagerkraft", "fb", "bearingreaction", "bearingreactionforce", "supportforce",
    "fbrg", "bearing", "lager", "fl", "bearingload", "forcebearing", "fbearing", "fbear",
}  # fmt: skip
_MESH_TORQUES = {"meshtorque", "contacttorque", "torquemesh", "tmesh", "zahnmoment", "eingriffsmoment"}
#: Words without gear and axis -> quantity.
_OF_THE_MESH = {
    **dict.fromkeys(
        ("te", "dte", "delta", "drehfehler", "drehabweichung", "drehwegabweichung", "drehwegfehler",
         "uebertragungsfehler", "dynamicte", "meshdeflection", "meshdeformation"), "dte"),
    **dict.fromkeys(
        ("fm", "meshforce", "contactforce", "fmesh", "fc", "fcontact", "zahnkraft", "eingriffskraft",
         "toothforce", "gearmeshforce", "meshload", "dmf", "forcemesh"), "mesh_force"),
    **dict.fromkeys(("friction", "slidingfriction", "frictionmesh", "reibung"), "friction"),
    **dict.fromkeys(
        ("meshstiffness", "km", "kmesh", "k", "eingriffssteifigkeit", "verzahnungssteifigkeit", "gms", "tvms",
         "gearmeshstiffness", "stiffness", "zahnsteifigkeit"), "mesh_stiffness"),
}  # fmt: skip
#: Words that name the load of one tooth pair, or the sum over all -> quantities of one pair and of all.
_OF_A_PAIR = {
    **dict.fromkeys(
        ("normalload", "normalforce", "fn", "n", "zahnnormalkraft", "normalkraft"),
        ("normal_load", "mesh_force"),
    ),
    **dict.fromkeys(
        ("frictionforce", "ff", "fr", "f", "reibkraft", "reibungskraft", "ffric", "ffriction"),
        ("friction_force", "friction"),
    ),
}  # fmt: skip


def _expansions() -> Iterator[tuple[str, list[str]]]:
    """Symbols without signs between their letters -> their words: xp, vx1, thetap, Fbx1."""
    ends = {"p": "p", "g": "g", "": ""}
    for axis, (end, word) in itertools.product("xy", ends.items()):
        for prefix in ("u", "v", "a", "b", "fb", "fl", "frb", "d"):
            words = {"frb": "fb", "a": "acc"}.get(prefix, prefix)
            yield f"{prefix}{axis}{end}", [words, axis, *([word] if word else [])]
        for ending in ("", "dot", "ddot"):
            yield f"{axis}{end}{ending}", [axis, *([word] if word else []), *([ending] if ending else [])]
            yield f"{axis}{ending}{end}", [axis, *([ending] if ending else []), *([word] if word else [])]
    for symbol, (end, word) in itertools.product(("theta", "phi", "omega"), ends.items()):
        for ending in ("", "dot", "ddot"):
            yield f"{symbol}{end}{ending}", [symbol, *([word] if word else []), *([ending] if ending else [])]
            yield f"{symbol}{ending}{end}", [symbol, *([ending] if ending else []), *([word] if word else [])]
    for symbol, ending in itertools.product(("te", "dte", "delta"), ("dot", "ddot")):
        yield f"{symbol}{ending}", [symbol, ending]


_EXPANDED = {symbol: words for symbol, words in _expansions() if words != [symbol]}


@lru_cache(maxsize=4096)
def meaning(text: str) -> Meaning | None:
    """Return the meaning of the words of a heading; None where the words are no quantity."""
    plain = text.strip()
    if plain.lower() in QUANTITIES and not QUANTITIES[plain.lower()].of_tooth_pair:
        return Meaning(plain.lower())
    for pattern, word in _PHRASES:
        plain = pattern.sub(f" {word} ", plain)
    label, plain = _without_label(plain)
    words = [word for word in words_of(plain) if word not in _FILLERS]
    compact = "".join(words)
    words = _EXPANDED.get(compact) or [part for word in words for part in _EXPANDED.get(word, [word])]
    if label is not None:
        return _of_pair("".join(words), label)
    return _of_mesh("".join(words)) or _of_gear(words)


def _without_label(text: str) -> tuple[str | None, str]:
    """Return the label of a tooth pair at the end of a name, and the name without the label."""
    match = re.search(rf"^(.*?)[ _.-]+(?:(?:tooth[ _-]*)?pair[ _-]*)?([{PAIR_LABELS}])$", text)
    if match is None:
        match = re.search(rf"^(.*?)[ _.-]+(?:tooth[ _-]*)?pair[ _-]*([{PAIR_LABELS}])$", text, re.IGNORECASE)
    return (match[2].upper(), match[1]) if match else (None, text)


def _of_pair(compact: str, label: str) -> Meaning | None:
    names = _OF_A_PAIR.get(compact) or _OF_A_PAIR.get(f"{compact}force")
    if names is None and compact in ("meshforce", "contactforce", "fm", "zahnkraft", "load", "force"):
        names = _OF_A_PAIR["normalload"]
    return Meaning(names[0], label) if names else None


def _of_mesh(compact: str) -> Meaning | None:
    if compact in _OF_THE_MESH:
        return Meaning(_OF_THE_MESH[compact])
    if compact in _OF_A_PAIR and compact not in ("n", "f"):
        name = _OF_A_PAIR[compact][1]
        return Meaning(name, assumption="is read as the sum over all tooth pairs")
    return None


def _of_gear(words: list[str]) -> Meaning | None:
    """Return a quantity of a gear, or a rate of a quantity."""
    if "rad" in words and _GERMAN & set(words):
        words = ["g" if word == "rad" else word for word in words]
    gears = {_GEAR_WORDS[word] for word in words if word in _GEAR_WORDS}
    numbered = any(word in _NUMBERS for word in words)
    if "gear" in words and not numbered:
        gears.add("g")
    axes = {_AXIS_WORDS[word] for word in words if word in _AXIS_WORDS}
    if len(gears) > 1 or len(axes) > 1:
        return None
    rest = [word for word in words if word not in _GEAR_WORDS and word not in _AXIS_WORDS and word != "gear"]
    if axes and gears and "a" in rest:
        rest[rest.index("a")] = "acc"
    derivative = sum(_RATES.get(word, 0) for word in rest)
    kind = "".join(word for word in rest if word not in _RATES)
    for ending, order in (("ddot", 2), ("dot", 1)):
        if kind.endswith(ending) and len(kind) > len(ending):
            kind = kind.removesuffix(ending)
            derivative += order
            break
    if kind in _SPEEDS or (kind == "" and "speed" in rest and not axes):
        derivative = 1 + (derivative - ("speed" in rest or kind in _RATES) if derivative else 0)
        kind = "theta"
    base = _base(kind, next(iter(gears), None), next(iter(axes), None))
    name = base + {0: "", 1: "_dot", 2: "_ddot"}.get(derivative, "?") if base else ""
    if name not in QUANTITIES:
        return None
    assumptions = []
    if numbered:
        assumptions.append("gear 1 is the pinion")
    if axes and not {"loa", "oloa"} & set(words):
        direction = "along" if axes == {"x"} else "across"
        assumptions.append(f"{next(iter(axes))} is {direction} the line of action")
    return Meaning(name, assumption=" and ".join(assumptions))


def _base(kind: str, gear: str | None, axis: str | None) -> str:
    """Name of a quantity without derivative; empty: no quantity."""
    if kind in _OF_THE_MESH and gear is None and axis is None:
        return _OF_THE_MESH[kind]
    if gear is None:
        return ""
    if axis is None:
        if kind in _MESH_TORQUES:
            return f"mesh_torque_{gear}"
        return f"theta_{gear}" if kind in _ROTATIONS else ""
    if kind in _BEARING_FORCES:
        return f"bearing_force_{axis}_{gear}"
    return f"{axis}_{gear}" if kind in _DISPLACEMENTS else ""


_ABSCISSAE: dict[str, AbscissaKind] = {
    **dict.fromkeys(("t", "time", "zeit", "xvalue", "xwert", "timestamp", "simulationtime", "tout",
                     "elapsedtime"), "time"),
    **dict.fromkeys(("meshphase", "meshcycle", "meshcycles", "phase", "tau", "ttm", "meshposition",
                     "eingriffsphase", "mesh", "numberofmeshcycles"), "mesh_phase"),
    **dict.fromkeys(("order", "orders", "meshorder", "meshorders", "ordnung", "harmonic", "harmonics", "ord",
                     "meshharmonic"), "order"),
    **dict.fromkeys(("rotationangle", "angle", "drehwinkel", "winkel", "pinionangle", "rollangle",
                     "pinionrollangle", "ritzelwinkel"), "pinion_angle"),
    **dict.fromkeys(("gearangle", "wheelangle", "gearrotationangle", "radwinkel"), "gear_angle"),
    **dict.fromkeys(("speed", "pinionspeed", "rpm", "n", "n1", "drehzahl", "inputspeed", "omega",
                     "rotationalspeed", "rotorspeed", "ritzeldrehzahl", "pinionrotationalspeed",
                     "np"), "speed"),
    **dict.fromkeys(("gearspeed", "outputspeed", "n2", "wheelspeed", "raddrehzahl", "ng"), "gear_speed"),
}  # fmt: skip


def abscissa(text: str) -> AbscissaKind | None:
    """Return the kind of abscissa that a name can be; None: the name is no abscissa."""
    return _ABSCISSAE.get("".join(words_of(text)))


_STATISTICS: tuple[tuple[re.Pattern[str], Statistic], ...] = (
    (re.compile(r"\b(peak[ -]*to[ -]*peak|pk[ -]*(to[ -]*)?pk|p[ -]*(to|2)[ -]*p|pp|ptp|p-p)\b", re.I),
     "peak_to_peak"),
    (re.compile(r"\b(rms|std|effektivwert)\b", re.I), "rms"),
    (re.compile(r"\b(mean|average|avg|mittelwert)\b", re.I), "mean"),
    (re.compile(r"\b(?:mesh[ -]*)?(?:order|harmonic|ordnung|h)[ -]*(\d+(?:\.\d+)?)\b", re.I), "order"),
    (re.compile(r"\b(\d+)(?:st|nd|rd|th|\.)[ -]*(?:mesh[ -]*)?(?:order|harmonic|ordnung)\b", re.I), "order"),
)  # fmt: skip


class Value(NamedTuple):
    """A value of a motion at one speed: its statistic, its order, and the words without both."""

    statistic: Statistic
    order: float
    words: str


def value_over_speed(text: str) -> Value | None:
    """Return the statistic that words name; None: the words name no statistic."""
    spaced = text.replace("_", " ")
    for pattern, statistic in _STATISTICS:
        if match := pattern.search(spaced):
            rest = f"{spaced[: match.start()]} {spaced[match.end() :]}"
            rest = re.sub(r"\b(amplitude|value)\b", " ", rest, flags=re.I)
            order = float(match[1]) if statistic == "order" else 0.0
            return Value(statistic, order, " ".join(rest.split()).strip(" -_.,"))
    return None


_PARTS: tuple[tuple[re.Pattern[str], Part], ...] = (
    (re.compile(r"\b(phase|phasenwinkel|arg)\b", re.I), "phase"),
    (re.compile(r"\b(real|re|realteil)\b", re.I), "real"),
    (re.compile(r"\b(imag|imaginary|im|imaginaerteil)\b", re.I), "imag"),
    (re.compile(r"\b(amplitude|magnitude|abs|amp|mag|betrag)\b", re.I), "amplitude"),
)


class PartOfOrder(NamedTuple):
    """Part of a complex amplitude, and the words without the part."""

    part: Part
    words: str


def part_of_order(text: str) -> PartOfOrder:
    """Return which part of a complex amplitude the words name; the amplitude where they name none."""
    spaced = text.replace("_", " ")
    for pattern, part in _PARTS:
        if match := pattern.search(spaced):
            rest = f"{spaced[: match.start()]} {spaced[match.end() :]}"
            return PartOfOrder(part, " ".join(rest.split()).strip(" -_.,"))
    return PartOfOrder("amplitude", text)


class Understood(NamedTuple):
    """A heading with its words, its unit and its meaning."""

    heading: Heading
    meaning: Meaning


def understood(heading: str) -> Understood | None:
    """Return the first reading of a heading that is a quantity."""
    for reading in readings(heading):
        if found := meaning(reading.words):
            return Understood(reading, found)
    return None


def abscissa_of(heading: str) -> tuple[AbscissaKind, Heading] | None:
    """Return the kind and the reading of a heading that can be an abscissa."""
    for reading in readings(heading):
        if kind := abscissa(reading.words):
            return kind, reading
    return None


def names_to_type() -> Iterable[str]:
    """Names that a heading can have."""
    for name, quantity in QUANTITIES.items():
        yield f"{name}_A" if quantity.of_tooth_pair else name

"""Numbers of a pair a second way, from its parameter file and the saved data; reading of printed numbers."""

import math
import re

import numpy as np
from scipy.optimize import brentq

_GEARS = ("pinion", "gear")
_PREFIX = {"G": 1e9, "M": 1e6, "k": 1e3, "m": 1e-3, "µ": 1e-6, "n": 1e-9, "p": 1e-12}
_PREFIXED = ("N/m", "m/s", "Pa", "Hz", "N", "W", "m", "s")
_SUPERSCRIPT = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")
_NUMBER = re.compile(r"([-+]?\d+(?:\.\d+)?)(?: × 10([⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+))?(?: (.+))?")


def unit_factor(unit):
    """Base unit and factor of a unit with a prefix: "kN" is ("N", 1e3)."""
    for base in _PREFIXED:
        if unit == base:
            return base, 1.0
        if unit.endswith(base) and unit[: -len(base)] in _PREFIX:
            return base, _PREFIX[unit[: -len(base)]]
    return unit, 1.0


def read(text):
    """Value in SI and base unit ("1" for none) of a printed number."""
    mantissa, power, unit = _NUMBER.fullmatch(text).groups()
    base, factor = unit_factor(unit or "1")
    return float(mantissa) * factor * 10.0 ** int((power or "0").translate(_SUPERSCRIPT)), base


def assert_printed(text, value, unit, digits=4):
    """A printed number is a value in its unit, to its digits; three where it has a power of ten."""
    number, base = read(text)
    digits = min(digits, 3) if "×" in text else digits
    assert base == unit or value == 0.0, (text, unit)
    assert abs(number - value) <= 0.51 * 10.0 ** (1 - digits) * abs(value) + 1e-300, (text, value)


def assert_says(sentence, pattern, *expected, digits=3):
    """A sentence has the form of a pattern, and its groups are the expected (value, unit), or text."""
    match = re.fullmatch(pattern, sentence)
    assert match, (sentence, pattern)
    for group, one in zip(match.groups(), expected, strict=True):
        if isinstance(one, str):
            assert group == one, (sentence, one)
        else:
            assert_printed(group, *one, digits=digits)


def static_force(parameters):
    """T_p over the pinion's base radius m z cos(alpha)/2 [N]; torque in N m, module in mm."""
    return parameters["operating"]["pinion_torque"] / base_radii(parameters)[0]


def base_radii(parameters):
    rack = parameters["basic_rack"]
    half = 0.5e-3 * rack["module"] * math.cos(math.radians(rack["pressure_angle"]))
    return tuple(half * parameters[gear]["teeth"] for gear in ("pinion", "gear"))


def mesh_frequency(parameters):
    return parameters["operating"]["pinion_speed"] / 60.0 * parameters["pinion"]["teeth"]


def power(parameters):
    operating = parameters["operating"]
    return operating["pinion_torque"] * operating["pinion_speed"] * math.pi / 30.0


def amplitudes(values, cycles=1):
    """Amplitudes at the orders 1 to 10 by sums of cosines and sines."""
    phase = 2.0 * np.pi * np.arange(values.size) * cycles / values.size
    orders = []
    for order in range(1, 11):
        c, s = (2.0 * np.mean(values * f(order * phase)) for f in (np.cos, np.sin))
        orders.append(math.hypot(c, s))
    return np.array(orders)


def operating_angle(parameters):
    """Operating pressure angle [rad] of gears that mesh without backlash: inv a_w = inv a + 2 tan a X/Z."""
    alpha = math.radians(parameters["basic_rack"]["pressure_angle"])
    shifts, teeth = (sum(parameters[g][key] for g in _GEARS) for key in ("profile_shift", "teeth"))
    wanted = math.tan(alpha) - alpha + 2.0 * math.tan(alpha) * shifts / teeth
    return brentq(lambda angle: math.tan(angle) - angle - wanted, 0.1, 1.0, xtol=1e-15)


def tip_alteration(parameters):
    """What keeps the clearance of the rack, k m [mm]: the centre distance less that of the full shifts."""
    r_p, r_g = base_radii(parameters)
    rack = parameters["basic_rack"]
    shifts, teeth = (sum(parameters[g][key] for g in _GEARS) for key in ("profile_shift", "teeth"))
    centre = 1e3 * (r_p + r_g) / math.cos(operating_angle(parameters))
    return min(0.0, centre - rack["module"] * (0.5 * teeth + shifts))


def path_of_contact(parameters):
    """A, P, D and the whole line of action X to Y [m].

    Tips are addendum and shift beyond the reference, or where the mate's root leaves the rack's clearance.
    """
    rack = parameters["basic_rack"]
    r_p, r_g = base_radii(parameters)
    working = math.tan(operating_angle(parameters))
    tips = [
        1e-3 * rack["module"] * (0.5 * gear["teeth"] + rack["addendum_coefficient"] + gear["profile_shift"])
        for gear in (parameters[name] for name in _GEARS)
    ]
    length = (r_p + r_g) * working
    depth = rack["dedendum_coefficient"]
    roots = [
        1e-3 * rack["module"] * (0.5 * gear["teeth"] - depth + gear["profile_shift"])
        for gear in (parameters[name] for name in _GEARS)
    ]
    clearance = 1e-3 * rack["module"] * (depth - rack["addendum_coefficient"])
    centre = (r_p + r_g) / math.cos(operating_angle(parameters))
    tips = [
        tip if "tip_alteration" in parameters[name] else min(tip, centre - root - clearance)
        for name, tip, root in zip(_GEARS, tips, roots[::-1], strict=True)
    ]
    end = math.sqrt(tips[0] ** 2 - r_p**2)
    start = length - math.sqrt(tips[1] ** 2 - r_g**2)
    return start, r_p * working, end, length


def contact(parameters, xi):
    """Modulus E' [Pa], reduced radius [m], full load per width [N/m], sum velocity [m/s] at xi."""
    _, _, _, length = path_of_contact(parameters)
    pinion, gear = parameters["pinion"], parameters["gear"]
    modulus = 2e9 / sum((1.0 - g["poisson_ratio"] ** 2) / g["youngs_modulus"] for g in (pinion, gear))
    load = static_force(parameters) / (1e-3 * min(pinion["face_width"], gear["face_width"]))
    omega = parameters["operating"]["pinion_speed"] * math.pi / 30.0
    rolling = omega * (xi + pinion["teeth"] / gear["teeth"] * (length - xi))
    return modulus, xi * (length - xi) / length, load, rolling


def films(parameters, xi):
    """Film of Dowson and Toyoda, of Hamrock and Dowson [m], and film parameter of the first, at xi."""
    modulus, radius, load, rolling = contact(parameters, xi)
    oil = parameters["lubricant"]
    gears = (parameters["pinion"], parameters["gear"])
    eta = 1e-3 * oil["viscosity"]
    g = 1e-6 * oil["pressure_viscosity_k"] * (1e3 * eta) ** oil["pressure_viscosity_s"] * modulus
    u = eta * rolling / (2.0 * modulus * radius)
    w = load / (modulus * radius)
    film = 3.06 * g**0.56 * u**0.69 * w**-0.10 * radius
    other = 2.69 * g**0.53 * u**0.67 * w**-0.067 * radius
    rough = 1e-6 * math.hypot(*(one["roughness"] for one in gears))
    band = 2.0 * np.sqrt(8.0 * load * radius / (math.pi * modulus))
    return film, other, film / rough * np.sqrt(1e-3 * parameters["friction"]["film_length"] / band)

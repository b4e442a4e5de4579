"""What every friction law shares: the contact along the path, the settings, the record of a law, its fit.

Sources: kinematics of the contact, Abbas Al-Zubaidi 2008, eqs. 5 and 11 to 15 with the repairs of the errata;
piecewise Chebyshev fits, Trefethen, Approximation Theory and Approximation Practice, 2013.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Protocol

import numpy as np
from scipy.optimize import brentq

from lumped.lubrication import film
from lumped.path_function import PathFunction
from lumped.ranges import ValidityRange
from lumped.typing import BoolArray, FloatArray

#: Distance from the pitch point [m] below which laws are held constant. A position xi near 0.01 m is known to
#: 2e-18 m, so xi - L_XP is known to 2e-10 of this distance and log10 of the sliding velocity to 1e-10; the
#: contact band is four orders wider.
PITCH_RESOLUTION = 1e-8

#: Range of the mean |mu| over the path that fits of lubricated contacts must not leave.
MEAN_COEFFICIENT = ValidityRange(
    "mean_coefficient",
    "1",
    None,
    0.1,
    "steel under boundary lubrication, 0.1 to 0.12; measured means of gears are 0.02 to 0.07",
)
_SEARCH_POINTS = 400
_ROOT_TOLERANCE = 1e-14  # relative, of the distance from the pitch point


@dataclass(frozen=True)
class ContactPath:
    """The nominal contact of one tooth pair along the path of contact, everything in SI.

    Attributes
    ----------
    L_XA, L_XP, L_XD, L_XY : distances from the pinion's tangent point X [m]
    omega_pinion, omega_gear : nominal speeds [rad/s]
    pitch_line_velocity : v_t on the operating pitch circles [m/s]
    unit_load : w_n, full static load per face width [N/m]
    effective_modulus : E' [Pa]
    viscosity : eta at the inlet, dynamic [Pa s]
    pressure_viscosity_k, pressure_viscosity_s : alpha = k eta^s (mm^2/N, mPa s)
    roughness : S, mean of the two average roughnesses [m]
    composite_roughness : R_comp [m]
    film_length : L_x [m]
    edge_pinion, edge_gear : lengths on the base tangents at which an undercut ends the flank [m]; 0 without
        one. An edge that touches further outside keeps the friction of the involute that ends there.
    """

    L_XA: float
    L_XP: float
    L_XD: float
    L_XY: float
    omega_pinion: float
    omega_gear: float
    pitch_line_velocity: float
    unit_load: float
    effective_modulus: float
    viscosity: float
    pressure_viscosity_k: float
    pressure_viscosity_s: float
    roughness: float
    composite_roughness: float
    film_length: float
    edge_pinion: float = 0.0
    edge_gear: float = 0.0

    def at_speed(self, omega_pinion: float) -> ContactPath:
        """The same contact at another speed of the pinion [rad/s].

        The ratio follows from the pitch point, where both flanks roll alike: it has the same digits whatever
        the speed.
        """
        return replace(
            self,
            omega_pinion=omega_pinion,
            omega_gear=omega_pinion * (self.L_XP / (self.L_XY - self.L_XP)),
            pitch_line_velocity=self.pitch_line_velocity * (omega_pinion / self.omega_pinion),
        )

    @property
    def base_radius_pinion(self) -> float:
        """r_bp [m], by Pythagoras from the operating pitch radius v_t/omega_p and L_XP."""
        return math.sqrt((self.pitch_line_velocity / self.omega_pinion) ** 2 - self.L_XP**2)

    def radius(self, xi: FloatArray) -> FloatArray:
        """Reduced radius of curvature rho_r = rho_p rho_g/(rho_p + rho_g) [m], equations (11) and (15)."""
        return xi * (self.L_XY - xi) / self.L_XY

    def held(self, xi: FloatArray) -> FloatArray:
        """Positions at which laws are evaluated: those beyond an edge are at the edge [m]."""
        low = self.edge_pinion or -math.inf
        return np.asarray(np.clip(xi, low, self.L_XY - (self.edge_gear or -math.inf)), dtype=np.float64)

    @property
    def edges(self) -> tuple[float, ...]:
        """Positions of the edges that undercuts leave [m]."""
        found = (self.edge_pinion, self.L_XY - self.edge_gear)
        return tuple(xi for xi, edge in zip(found, (self.edge_pinion, self.edge_gear), strict=True) if edge)

    def sliding_velocity(self, xi: FloatArray) -> FloatArray:
        """v_s = |v_rp - v_rg| [m/s], equation (13); written in xi - L_XP so that it is 0 exactly at P."""
        return (self.omega_pinion + self.omega_gear) * np.abs(xi - self.L_XP)

    def entraining_velocity(self, xi: FloatArray) -> FloatArray:
        """v_e = v_rp + v_rg [m/s], the sum velocity, equation (13)."""
        return self.omega_pinion * xi + self.omega_gear * (self.L_XY - xi)

    @property
    def still(self) -> float | None:
        """Where v_e would be 0, beyond the path [m]; None where it is the same everywhere."""
        apart = self.omega_gear - self.omega_pinion
        return self.omega_gear * self.L_XY / apart if apart else None

    def slide_to_roll(self, xi: FloatArray) -> FloatArray:
        """SR = 2 v_s/v_e [-], equation (17)."""
        return 2.0 * self.sliding_velocity(xi) / self.entraining_velocity(xi)

    def hertz_pressure(self, xi: FloatArray) -> FloatArray:
        """Largest Hertzian pressure p_h [Pa], equation (16)."""
        return 1e9 * film.hertz_pressure(
            self.unit_load * 1e-3, self.radius(xi) * 1e3, self.effective_modulus * 1e-6
        )

    def half_width(self, xi: FloatArray) -> FloatArray:
        """Half width b_H of the contact band [m]."""
        return 1e-3 * film.hertz_half_width(
            self.unit_load * 1e-3, self.radius(xi) * 1e3, self.effective_modulus * 1e-6
        )

    def film_thickness(self, xi: FloatArray, formula: str = "dowson_toyoda") -> FloatArray:
        """Central film thickness h_c [m], equation (21); ``formula`` as of ``film.film_thickness``."""
        return 1e-6 * film.film_thickness(
            self.unit_load * 1e-3,
            self.radius(xi) * 1e3,
            self.viscosity * 1e3,
            self.entraining_velocity(xi),
            self.effective_modulus * 1e-6,
            pressure_viscosity_k=self.pressure_viscosity_k,
            pressure_viscosity_s=self.pressure_viscosity_s,
            formula=formula,
        )

    def film_parameter(self, xi: FloatArray) -> FloatArray:
        """Film parameter Lambda [-], equation (21)."""
        return film.film_parameter(
            self.film_thickness(xi) * 1e6,
            self.half_width(xi) * 1e3,
            self.composite_roughness * 1e6,
            self.film_length * 1e3,
        )

    def crossings(self, function: Callable[[FloatArray], FloatArray]) -> list[float]:
        """Positions strictly inside A..D where a continuous function of xi changes sign [m].

        The search runs over distances from the pitch point that grow geometrically, because bounded laws may
        leave their bounds close to P. Two roots within four per cent of the same distance would be missed:
        the function then touches its level without consequence.
        """
        result = []
        for side, reach in ((-1.0, self.L_XP - self.L_XA), (1.0, self.L_XD - self.L_XP)):
            distances = np.geomspace(PITCH_RESOLUTION, reach * (1.0 - 1e-12), _SEARCH_POINTS)
            values = function(self.L_XP + side * distances)

            def at(distance: float, side: float = side) -> float:
                return float(function(np.array(self.L_XP + side * distance)))

            for j in np.flatnonzero(np.signbit(values[:-1]) != np.signbit(values[1:])):
                low, high = float(distances[j]), float(distances[j + 1])
                if at(low) * at(high) > 0.0:  # a root on the grid, taken by its neighbour
                    continue
                root = brentq(at, low, high, xtol=1e-9 * PITCH_RESOLUTION, rtol=_ROOT_TOLERANCE)
                result.append(self.L_XP + side * float(root))
        return sorted(xi for xi in result if self.L_XA < xi < self.L_XD)


class FrictionSettings(Protocol):
    """Parameters of the friction laws, the fields of ``friction`` in a parameter file.

    Attributes
    ----------
    law : name of the pair's own law
    coefficient : mu_avg of laws I and IV [-]; None takes law II's average over the path, as in the paper
    sharpness : Phi of law IV [1/m]
    maximum : upper bound of law II [-]
    thresholds : film parameters at which law V changes over
    """

    law: str
    coefficient: float | None
    sharpness: float
    maximum: float
    thresholds: tuple[float, float, float]

    @property
    def own_law(self) -> FrictionLaw | None:
        """The law of the user's table, where one is given."""

    def __hash__(self) -> int:
        """Results are kept by the settings."""


Analytic = Callable[[FloatArray, FloatArray, ContactPath, FrictionSettings], tuple[FloatArray, FloatArray]]
"""See `FrictionLaw`."""


@dataclass(frozen=True)
class FrictionLaw:
    """Everything that is particular to one law. Files, commands, charts and legends read it from here.

    Attributes
    ----------
    name : as in parameter files
    label : for tables and legends
    signed : (xi [m], path, settings) -> signed mu [-], vectorised over xi
    switches : (path, settings) -> positions where mu jumps or has a kink [m]
    numeral : Roman number in the paper's order; empty for a law that the paper does not have
    ranges : validity ranges of the law's arguments
    parts : for a law made of others, (xi, path, settings) -> pairs of a law and where it is in force
    coefficient : whether |mu| far from the pitch point is one number, ``friction.coefficient``
    reads : what mu depends on beside places, speeds and load, by the names of ``ContactPath`` and
        ``FrictionSettings``; a mean of law II where no coefficient is given is added. None: on all of them
    varies : whether mu depends on speed, load, oil or flanks (a law with a coefficient: where none is given)
    fluid_film : whether the law was fitted to contacts that an oil film carries in part or in full
    factor : (path, settings) -> number to which mu is proportional over speed, all else equal; None: speed
        changes the shape of mu too
    shift : (path, settings) -> number by which |mu| rises as a whole over speed, as long as no switch moves
    analytic : (low [m], high [m], path, settings) -> for pieces (k,) between switches the ratio r of ellipses
        in which the formula is analytic, and a bound on |mu| there, see `lumped.friction.misfit`; None: there
        is no formula, and the fit is the law
    joints : path -> positions where polynomials of a table meet, without jump or kink [m]
    """

    name: str
    label: str
    signed: Callable[[FloatArray, ContactPath, FrictionSettings], FloatArray]
    switches: Callable[[ContactPath, FrictionSettings], list[float]]
    numeral: str = ""
    ranges: tuple[ValidityRange, ...] = ()
    parts: (
        Callable[[FloatArray, ContactPath, FrictionSettings], list[tuple[FrictionLaw, BoolArray]]] | None
    ) = None
    coefficient: bool = False
    reads: frozenset[str] | None = None
    varies: bool = True
    fluid_film: bool = False
    factor: Callable[[ContactPath, FrictionSettings], float] | None = None
    shift: Callable[[ContactPath, FrictionSettings], float] | None = None
    analytic: Analytic | None = None
    joints: Callable[[ContactPath], list[float]] = lambda path: []

    @property
    def title(self) -> str:
        """Number and label, for tables and legends."""
        return f"{self.numeral} {self.label}".lstrip()

    def is_constant(self, settings: FrictionSettings) -> bool:
        """Whether mu(xi) is the same at every speed and load."""
        return not self.varies or (self.coefficient and settings.coefficient is not None)

    def over_speed(self, path: ContactPath, settings: FrictionSettings) -> tuple[ContactPath, float] | None:
        """The contact at ``FIT_SPEED`` and the factor from mu there to mu here; None: the shapes differ."""
        there = path.at_speed(FIT_SPEED)
        unit = 0.0 if self.factor is None else self.factor(there, settings)
        return None if self.factor is None or unit == 0.0 else (there, self.factor(path, settings) / unit)


#: Absolute error of mu in the piecewise polynomials.
FIT_TOLERANCE = 1e-10
#: Pinion speed [rad/s] at which laws are fitted that speed only scales: near 1000 rpm, in the middle of use.
FIT_SPEED = 100.0
#: Breaks closer than this share of the path of contact are one.
_SAME = 1e-9
_FIRST_CUT = 64.0  # a piece that ends at P is cut at this fraction of its length
_GEOMETRIC_ABOVE = 2.0  # pieces whose ends are further apart than this ratio are cut at the geometric mean


def fit_signed(law: FrictionLaw, path: ContactPath, settings: FrictionSettings) -> PathFunction:
    """Signed mu(xi) of a law on [L_XA, L_XD], within ``FIT_TOLERANCE`` wherever it is smooth.

    Where speed only scales mu, one fit at ``FIT_SPEED`` serves all speeds, so that results at different
    speeds rest on the same polynomials.
    """
    scaled = law.over_speed(path, settings)
    return _fit(law, path, settings) if scaled is None else _fit(law, scaled[0], settings).scaled(scaled[1])


@lru_cache(maxsize=256)
def _fit(law: FrictionLaw, path: ContactPath, settings: FrictionSettings) -> PathFunction:
    """The fit of `fit_signed` at the speed of the path.

    Around the pitch point law II has a logarithm, law III the power 1.036 and law IV a width of its own.
    """
    switches = sorted({xi for xi in law.switches(path, settings) if path.L_XA < xi < path.L_XD})
    # The pitch point is a break of every law: also where mu is smooth there, it varies fastest around it.
    breaks = sorted({path.L_XA, path.L_XP, path.L_XD, *switches})
    near = _SAME * (path.L_XD - path.L_XA)
    joints = [xi for xi in (*law.joints(path), *path.edges) if path.L_XA < xi < path.L_XD]
    breaks = sorted([*breaks, *(xi for xi in joints if min(abs(xi - b) for b in breaks) > near)])
    return PathFunction.fit(
        lambda xi: law.signed(path.held(xi), path, settings),
        breaks,
        switches,
        tolerance=FIT_TOLERANCE,
        cut=graded_breaks(path.L_XP),
    )


def graded_breaks(pitch: float) -> Callable[[FloatArray, FloatArray], FloatArray]:
    """How to cut pieces: nearer to a point [m] the longer a piece is against its distance from it."""

    def cut(low: FloatArray, high: FloatArray) -> FloatArray:
        side = np.where(0.5 * (low + high) >= pitch, 1.0, -1.0)
        near = np.where(side > 0, low - pitch, pitch - high)
        far = np.where(side > 0, high - pitch, pitch - low)
        geometric = np.where(near > 0.0, np.sqrt(near * far), far / _FIRST_CUT)
        distance = np.where(far > _GEOMETRIC_ABOVE * near, geometric, 0.5 * (near + far))
        return np.asarray(pitch + side * distance, dtype=np.float64)

    return cut


def mean_coefficient(function: PathFunction) -> float:
    """Mean of |mu| over the path of contact [-].

    Parameters
    ----------
    function : signed mu(xi), changing sign at its breaks only
    """
    breaks = function.breaks
    middles = 0.5 * (breaks[:-1] + breaks[1:])
    signs = np.where(function(middles) < 0.0, -1.0, 1.0)
    return PathFunction(breaks, function.coefficients * signs, function.switches).mean()

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

from lumped.lubrication import film
from lumped.path_function import PathFunction
from lumped.ranges import ValidityRange
from lumped.root_in_bracket import root_in_bracket
from lumped.typing import BoolArray, FloatArray

#: Distance from the pitch point [m] below which law II is constant. A position xi near 0.01 m is known to
#: 2e-18 m. So xi - L_XP is known to 2e-10 of this distance, and log10 of the sliding velocity to 1e-10. The
#: contact band is wider by four orders of magnitude.
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
_SAMPLED_POSITIONS = 201
_ROOT_TOLERANCE = 1e-14  # relative, of the distance from the pitch point
#: `FrictionLaw.roundings` of a law: the exponent of law III is near 9, each power adds 20, and the product
#: with `ContactPath.friction_factor` adds 1.
ROUNDINGS = 400.0


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
        an undercut. A contact of the edge further outside has the friction of the end of the involute.
    law_two_mean : mean of |mu| of law II from A to D [-], where the path is longer than from A to D, see
        `lumped.friction.average_coefficient`. None: the mean is that over this path.
    friction_factor : factor on mu of every law [-], positive, the same at every position, speed and load. A
        `FrictionLaw` applies the factor, and nothing else does. mu_avg is without the factor.
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
    law_two_mean: float | None = None
    friction_factor: float = 1.0

    def at_speed(self, omega_pinion: float) -> ContactPath:
        """The same contact at another speed of the pinion [rad/s].

        The speed of the gear follows from the pitch point, where both flanks roll with the same velocity. So
        the ratio of the speeds has the same digits at every speed. ``law_two_mean`` does not change.
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

    @property
    def sampled_positions(self) -> FloatArray:
        """Positions (201,) evenly spaced inside the path, at which mu and its ranges are checked [m]."""
        return self.between_edges(np.linspace(self.L_XA, self.L_XD, _SAMPLED_POSITIONS + 2)[1:-1])

    def between_edges(self, xi: FloatArray) -> FloatArray:
        """Positions [m] on the involutes: a position beyond the edge of an undercut becomes the edge."""
        low = self.edge_pinion or -math.inf
        return np.asarray(np.clip(xi, low, self.L_XY - (self.edge_gear or -math.inf)), dtype=np.float64)

    @property
    def edges(self) -> tuple[float, ...]:
        """Positions of the edges that undercuts leave [m]."""
        positions = (self.edge_pinion, self.L_XY - self.edge_gear)
        lengths = (self.edge_pinion, self.edge_gear)
        return tuple(xi for xi, length in zip(positions, lengths, strict=True) if length)

    def sliding_velocity(self, xi: FloatArray) -> FloatArray:
        """v_s = |v_rp - v_rg| [m/s], equation (13). The factor xi - L_XP makes v_s exactly 0 at P."""
        return (self.omega_pinion + self.omega_gear) * np.abs(xi - self.L_XP)

    def entraining_velocity(self, xi: FloatArray) -> FloatArray:
        """v_e = v_rp + v_rg [m/s], the sum velocity, equation (13)."""
        return self.omega_pinion * xi + self.omega_gear * (self.L_XY - xi)

    @property
    def still(self) -> float | None:
        """Position at which v_e would be 0, beyond the path [m]. None: v_e is the same everywhere."""
        difference = self.omega_gear - self.omega_pinion
        return self.omega_gear * self.L_XY / difference if difference else None

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
        leave their bounds close to P. The search does not see two roots within four per cent of the same
        distance. Such a function touches its level without consequence.
        """
        roots = []
        for side, reach in ((-1.0, self.L_XP - self.L_XA), (1.0, self.L_XD - self.L_XP)):
            distances = np.geomspace(PITCH_RESOLUTION, reach * (1.0 - 1e-12), _SEARCH_POINTS)
            values = function(self.L_XP + side * distances)

            def value(distance: float, side: float = side) -> float:
                return float(function(np.array(self.L_XP + side * distance)))

            for j in np.flatnonzero(np.signbit(values[:-1]) != np.signbit(values[1:])):
                low, high = float(distances[j]), float(distances[j + 1])
                if value(low) * value(high) > 0.0:  # a root on the grid: the next interval has it
                    continue
                root = root_in_bracket(value, low, high, xtol=1e-9 * PITCH_RESOLUTION, rtol=_ROOT_TOLERANCE)
                roots.append(self.L_XP + side * float(root))
        return sorted(xi for xi in roots if self.L_XA < xi < self.L_XD)


class FrictionSettings(Protocol):
    """Parameters of the friction laws, fields of ``friction`` in a parameter file (``schema.contact``).

    Attributes
    ----------
    law : name of the law of the pair, as in parameter files
    coefficient : mu_avg of laws I and IV [-]. None: the mean of law II over the path, as in the paper
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
        """The law of the user's table. None: the pair has no table."""

    def __hash__(self) -> int:
        """Fits are cached by path and settings."""


Analytic = Callable[[FloatArray, FloatArray, ContactPath, FrictionSettings], tuple[FloatArray, FloatArray]]
"""See `FrictionLaw`."""


@dataclass(frozen=True)
class FrictionLaw:
    """Everything that is particular to one law; files, commands, charts and legends read this record.

    The rest of the program assumes nothing about a law but what this record says. Each property has a test
    over all registered laws, ``tests/lumped/friction/test_law_properties.py``.

    The fields describe the formula. A pair has mu of the formula times ``ContactPath.friction_factor``:
    `signed`, `rise`, `change_by_average` and `most_around` include this factor, and whatever uses a law calls
    these. Switches, the ratio of mu at two speeds and the parts of a law are the same with any factor.

    Attributes
    ----------
    name : as in parameter files
    label : for tables and legends
    formula : (xi [m], path, settings) -> signed mu [-], vectorised over xi, at positions on the involutes
    switches : (path, settings) -> positions where mu jumps or has a kink [m]
    numeral : Roman number in the paper's order; empty for a law that the paper does not have
    ranges : validity ranges of the law's arguments
    parts : for a law made of others, (xi, path, settings) -> pairs of a law and where that law is in force
    coefficient : whether |mu| far from the pitch point is one number, mu_avg
    average_slope : bound on |d mu/d mu_avg|; 0 for a law that does not read mu_avg
    reads : what mu depends on beside positions, speeds and load, by the names of ``ContactPath`` and
        ``FrictionSettings``. A law that reads "coefficient" also depends on what law II reads, where the pair
        has no coefficient. None: mu depends on all of them
    varies : whether mu depends on speed, load, oil or flanks; of a law with mu_avg, where the pair has no
        coefficient
    fluid_film : whether the law was fitted to contacts that an oil film carries in part or in full
    factor : (path, settings) -> number to which mu is proportional over speed, all else equal. None: speed
        also changes the shape of mu
    shift : (path, settings) -> number by which |mu| rises as a whole over speed, as long as no switch moves
    roundings : bound on the relative error of the formula by rounding, in units of 2^-53
    analytic : (low [m], high [m], path, settings) -> for pieces (k,) between switches the ratio r of ellipses
        in which the formula is analytic, and a bound on |mu| in these ellipses, see `lumped.friction.misfit`.
        None: there is no formula, and the fit is the law
    joints : path -> positions where polynomials of a table meet, without jump or kink [m]
    """

    name: str
    label: str
    formula: Callable[[FloatArray, ContactPath, FrictionSettings], FloatArray]
    switches: Callable[[ContactPath, FrictionSettings], list[float]]
    numeral: str = ""
    ranges: tuple[ValidityRange, ...] = ()
    parts: (
        Callable[[FloatArray, ContactPath, FrictionSettings], list[tuple[FrictionLaw, BoolArray]]] | None
    ) = None
    coefficient: bool = False
    average_slope: float = 0.0
    reads: frozenset[str] | None = None
    varies: bool = True
    fluid_film: bool = False
    factor: Callable[[ContactPath, FrictionSettings], float] | None = None
    shift: Callable[[ContactPath, FrictionSettings], float] | None = None
    roundings: float = ROUNDINGS
    analytic: Analytic | None = None
    joints: Callable[[ContactPath], list[float]] = lambda path: []

    @property
    def title(self) -> str:
        """Number and label, for tables and legends."""
        return f"{self.numeral} {self.label}".lstrip()

    def signed(self, xi: FloatArray, path: ContactPath, settings: FrictionSettings) -> FloatArray:
        """Signed mu at positions [-]. Beyond the edge of an undercut mu is the value at the edge."""
        return path.friction_factor * self.formula(path.between_edges(xi), path, settings)

    def rise(self, path: ContactPath, settings: FrictionSettings) -> float:
        """Number by which |mu| rises as a whole over speed, ``shift`` of a law that has it [-]."""
        assert self.shift is not None
        return path.friction_factor * self.shift(path, settings)

    def change_by_average(self, path: ContactPath) -> float:
        """Bound on |d mu/d mu_avg| [-]."""
        return path.friction_factor * self.average_slope

    def most_around(
        self, low: FloatArray, high: FloatArray, path: ContactPath, settings: FrictionSettings
    ) -> tuple[FloatArray, FloatArray] | None:
        """Ratio of ellipses (k,) around pieces, and a bound on |mu| in these (k,), see ``analytic``."""
        if self.analytic is None:
            return None
        ratio, most = self.analytic(low, high, path, settings)
        return ratio, path.friction_factor * most

    def reads_average(self, path: ContactPath, settings: FrictionSettings) -> bool:
        """Whether mu_avg acts somewhere on a path. A law made of others: in a part that is in force."""
        if self.parts is None:
            return self.coefficient
        parts = self.parts(path.sampled_positions, path, settings)
        return any(part.coefficient and bool(inside.any()) for part, inside in parts)

    def is_constant(self, settings: FrictionSettings) -> bool:
        """Whether mu(xi) is the same at every speed and load."""
        return not self.varies or (self.coefficient and settings.coefficient is not None)

    def over_speed(self, path: ContactPath, settings: FrictionSettings) -> tuple[ContactPath, float] | None:
        """The contact at ``FIT_SPEED``, and mu over mu at ``FIT_SPEED``. None: the shapes differ."""
        if self.factor is None:
            return None
        at_fit_speed = path.at_speed(FIT_SPEED)
        divisor = self.factor(at_fit_speed, settings)
        return None if divisor == 0.0 else (at_fit_speed, self.factor(path, settings) / divisor)


#: Absolute error of mu in the piecewise polynomials.
FIT_TOLERANCE = 1e-10
#: Pinion speed [rad/s], near 1000 rpm, at which laws are fitted that speed only scales.
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
    if scaled is None:
        return _fit(law, path, settings)
    at_fit_speed, factor = scaled
    return _fit(law, at_fit_speed, settings).scaled(factor)


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
        lambda xi: law.signed(xi, path, settings),
        breaks,
        switches,
        tolerance=FIT_TOLERANCE,
        cut=graded_breaks(path.L_XP),
    )


def graded_breaks(pitch: float) -> Callable[[FloatArray, FloatArray], FloatArray]:
    """A rule that cuts pieces (low, high), (k,), in two.

    A piece is cut in the middle, or nearer to the pitch point where the piece is long against its distance
    from the pitch point.

    Parameters
    ----------
    pitch : position of the pitch point [m]
    """

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

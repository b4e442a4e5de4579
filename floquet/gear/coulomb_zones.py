"""A gear pair with one degree of freedom and Coulomb friction: the damped Meissner equation in closed form.

Vaishya and Singh (J. Sound Vib. 243 (2001) 525-545) write the gear pair on rigid bearings as one equation
for the dynamic transmission error, whose coefficients are constant between the events of the cycle, and solve
it by state transition matrices piece by piece. This module states that problem for unity ratio and equal
inertias, where it is exact: with 1/m_e = r^2/J_p + r^2/J_g = 2 r^2/J and moment arms X_p + X_g = L_XY,

    m_e delta'' + sum_i (1 + s_i mu tan alpha) (c_i delta' + k_i delta) = T_p/r_b ,

because the friction force s_i mu N_i acts with the arm m_e (r X_p/J + r X_g/J) = L_XY/(2 r) = tan alpha, the
same at every point of contact. Friction multiplies each pair's stiffness and damping by 1 + s_i mu tan alpha,
s_i = -1 in approach and +1 in recess. In double contact with one pair on either side of the pitch point the
two cancel. Lengths of time are in parts of the mesh cycle, frequencies in units of omega.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal, get_args

import numpy as np
import numpy.typing as npt

from floquet.engine.system import PeriodicSystem, second_order
from lumped.arguments import one_of, real_number, real_numbers
from lumped.errors import refuse
from lumped.labelling import labelled_dataset
from lumped.typing import ComplexArray, FloatArray

if TYPE_CHECKING:
    import xarray as xr

    from lumped.schema.pair import GearPair

FrictionSign = Literal["reversing", "constant"]
SPEED_RATIOS = np.linspace(0.3, 2.6, 921)
DAMPING_RATIOS = np.linspace(0.0, 0.1, 201)


@dataclass(frozen=True)
class CoulombGearPair:
    """One-degree-of-freedom gear pair of unity ratio with pairs of constant stiffness.

    Attributes
    ----------
    contact_ratio : 1 <= sigma <= 2
    damping_ratio : zeta of the mean mesh, c_i = zeta k_i 2/omega, damping in proportion to stiffness
    friction : mu >= 0
    pressure_angle : operating pressure angle alpha [rad]
    sign : "reversing", the friction force turns round at the pitch point, as on real teeth; or "constant",
        s_i = +1 everywhere, the simplification whose effect the study shows
    """

    contact_ratio: float = 1.638
    damping_ratio: float = 0.05
    friction: float = 0.0
    pressure_angle: float = np.deg2rad(20.0)
    sign: FrictionSign = "reversing"

    def __post_init__(self) -> None:
        real_number("contact_ratio", self.contact_ratio, 1.0, 2.0)
        real_number("damping_ratio", self.damping_ratio, 0.0)
        real_number("friction", self.friction, 0.0, 1.0 - 1e-15)
        real_number("pressure_angle", self.pressure_angle, 0.0, 0.25 * np.pi, above=True, unit="rad")
        one_of("sign", self.sign, get_args(FrictionSign))

    @property
    def phases(self) -> FloatArray:
        """Events of the cycle as its parts: a pair enters, the older one leaves, the pitch point, the end.

        The pitch point halves the path of contact (equal gears), so it is passed at sigma/2 of the cycle, in
        single contact.
        """
        return np.array([0.0, self.contact_ratio - 1.0, 0.5 * self.contact_ratio, 1.0])

    @property
    def gains(self) -> FloatArray:
        """Total mesh stiffness in each of the three pieces over its mean without friction, (3,).

        Two pairs, one in approach and one in recess; one in approach; one in recess.
        """
        m = self.friction * float(np.tan(self.pressure_angle))
        approach, recess = (1.0 - m, 1.0 + m) if self.sign == "reversing" else (1.0 + m, 1.0 + m)
        return np.array([approach + recess, approach, recess]) / self.contact_ratio

    def system(self, speed_ratio: float) -> PeriodicSystem:
        """Return the pair for the general engine, states (delta, delta') with time in 1/omega.

        Parameters
        ----------
        speed_ratio : mesh frequency over the natural frequency omega of the mean mesh
        """
        advice = "Give mesh frequency over natural frequency."
        period = 2.0 * np.pi / real_number("speed_ratio", speed_ratio, 0.0, above=True, action=advice)
        phases, gains, zeta = self.phases, self.gains, self.damping_ratio

        def A(t: FloatArray) -> FloatArray:
            g = gains[np.clip(np.searchsorted(phases, t / period, side="right") - 1, 0, 2), None, None]
            return second_order(g, 2.0 * zeta * g)

        return PeriodicSystem(A, period, tuple(phases[1:-1] * period), vectorized=True)

    def transition(self, speed_ratio: npt.ArrayLike, piece: int) -> FloatArray:
        """State transition matrix over one piece of the cycle in closed form, (...,) -> (..., 2, 2).

        x'' + 2 a x' + g x = 0 over h: exp(-a h) times the matrix of cos, sin(w h)/w with w^2 = g - a^2, which
        stays valid for the overdamped and the critical case with complex w.
        """
        h = np.diff(self.phases)[piece] * 2.0 * np.pi / np.asarray(speed_ratio, dtype=float)
        g = self.gains[piece]
        a = self.damping_ratio * g
        w = np.sqrt(complex(g - a * a))
        cosine = np.cos(w * h).real
        sine = (h * np.sinc(w * h / np.pi)).real  # sin(w h)/w without a division by zero
        rows = [[cosine + a * sine, sine], [-g * sine, cosine - a * sine]]
        return np.asarray(np.exp(-a * h)[..., None, None] * np.moveaxis(np.array(rows), (0, 1), (-2, -1)))

    def monodromy_matrix(self, speed_ratio: npt.ArrayLike) -> FloatArray:
        """Product of the three transition matrices, the first piece acting first; (...,) -> (..., 2, 2)."""
        first, second, third = (self.transition(speed_ratio, piece) for piece in range(3))
        return np.asarray(third @ second @ first)

    def multipliers(self, speed_ratio: npt.ArrayLike) -> ComplexArray:
        """Both multipliers, the larger modulus first, (...,) -> (..., 2).

        lambda^2 - tr M lambda + det M = 0 with det M = exp(-integral of 2 zeta g) (Liouville) exactly.
        """
        ratio = np.asarray(speed_ratio, dtype=float)
        M = self.monodromy_matrix(ratio)
        half = 0.5 * np.trace(M, axis1=-2, axis2=-1)
        decay = 2.0 * self.damping_ratio * float(self.gains @ np.diff(self.phases)) * 2.0 * np.pi / ratio
        determinant = np.exp(-decay)
        root = np.sqrt((half**2 - determinant).astype(complex))
        large = half + np.where(half < 0.0, -1.0, 1.0) * root
        return np.stack([large, determinant / large], axis=-1)


def stability_zones(
    pair: CoulombGearPair,
    speed_ratios: npt.ArrayLike = SPEED_RATIOS,
    damping_ratios: npt.ArrayLike = DAMPING_RATIOS,
) -> xr.Dataset:
    """Spectral radius without friction, with friction that reverses, and with friction of one sign.

    Parameters
    ----------
    pair : its contact ratio, pressure angle and coefficient are used
    speed_ratios : (k,) mesh frequency over the natural frequency of the mean mesh
    damping_ratios : (n,) zeta of the mean mesh

    Returns
    -------
    Dataset over ``friction`` ("none", "reversing", "constant"), ``damping_ratio`` and ``speed_ratio``:
    ``spectral_radius``
    """
    cases = {
        "none": replace(pair, friction=0.0),
        "reversing": replace(pair, sign="reversing"),
        "constant": replace(pair, sign="constant"),
    }
    speeds = real_numbers("speed_ratios", speed_ratios, 0.0, above=True)
    dampings = real_numbers("damping_ratios", damping_ratios, 0.0)
    radius = [
        [np.abs(replace(case, damping_ratio=float(zeta)).multipliers(speeds)[:, 0]) for zeta in dampings]
        for case in cases.values()
    ]
    dims = ("friction", "damping_ratio", "speed_ratio")
    return labelled_dataset(
        {"spectral_radius": (dims, np.array(radius), "1", "spectral radius, closed form")},
        {
            "friction": (np.array(list(cases), dtype=object), "1", "friction"),
            "damping_ratio": (dampings, "1", "mesh damping ratio"),
            "speed_ratio": (speeds, "1", "mesh frequency over natural frequency of the mean mesh"),
        },
        {
            "title": "stability zones of a pair with one degree of freedom and Coulomb friction",
            "friction_coefficient": pair.friction,
            "contact_ratio": pair.contact_ratio,
            "pressure_angle": float(np.rad2deg(pair.pressure_angle)),
        },
    )


def coulomb_gear_pair(pair: GearPair, friction: float) -> CoulombGearPair:
    """One-degree-of-freedom pair with the contact ratio and pressure angle of a gear pair.

    Parameters
    ----------
    pair : the gear pair, of unity ratio and contact ratio up to 2
    friction : coefficient

    Raises
    ------
    ParameterError : another ratio, for which friction does not only scale the stiffness
    """
    if pair.gear.teeth != pair.pinion.teeth:
        raise refuse(
            "gear.teeth",
            pair.gear.teeth,
            f"{pair.pinion.teeth}, as the pinion",
            "The closed form holds for unity ratio, for example --set gear.teeth=... or preset nasa_28_28.",
        )
    g = pair.geometry
    return CoulombGearPair(
        contact_ratio=g.contact_ratio, friction=friction, pressure_angle=g.operating_pressure_angle
    )

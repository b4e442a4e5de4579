"""The gear pair with one degree of freedom: the dynamic transmission error on rigid bearings, with friction.

    m delta'' + c(t) delta' + k(t) delta = F + f(t),
    k = SUM k_i (1 + mu_i a(xi_i)),  c = SUM c_i (1 + mu_i a(xi_i)),  a = m (r_bp xi/J_p + r_bg (L - xi)/J_g)

Sources: docs/theory/floquet.md, "One degree of freedom"; docs/theory/equations.md, eqs. 1 and 2; M. Vaishya
and R. Singh, J. Sound Vib. 243 (2001) 525-545 and 248 (2001) 671-694; J. Mech. Des. 125 (2003) 383-393.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Literal, get_args

import numpy as np
import numpy.typing as npt

from floquet.engine.chart import Axes
from floquet.engine.coefficients import PeriodicMatrix, PiecewisePolynomial
from floquet.engine.system import PeriodicSystem
from floquet.gear.axes import GearVariation
from floquet.gear.chart import stability_chart
from floquet.gear.multipliers import GearPairMultipliers, feedback_system, fitted_block, gear_pair_multipliers
from floquet.one_degree.closed_form import FrictionLoad, closed_form, force_by_torques, friction_arm
from floquet.one_degree.linear_segments import LinearSegments
from lumped.arguments import one_of, real_array, real_number
from lumped.display.progress import shows_progress
from lumped.labelling import provenance
from lumped.model.periodic_system import LTVSystem
from lumped.model.powers import power_attributes
from lumped.model.results import labelled
from lumped.model.steady import periodic_solution, sample_times
from lumped.quasi_static.contacts import mesh_elements
from lumped.quasi_static.elements import mean_of_pairs
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray, ProgressRequest

if TYPE_CHECKING:
    import xarray as xr

#: Stiffness of a tooth pair: as the pair has it, or one constant from A to D.
Stiffness = Literal["pair", "rectangular"]
#: Variables of ``lumped.steady_state`` that rigid bearings leave out.
_LEFT_OUT = ("x_p", "x_g", "y_p", "y_g")
#: Springs of rigid bearings: the static state of loaded contact has their deflection in it.
_RIGID = {
    "loa_stiffness": 1e30, "oloa_stiffness": 1e30, "loa_damping_ratio": 0.0, "oloa_damping_ratio": 0.0,
}  # fmt: skip


@dataclass(frozen=True, eq=False)
class SingleDegree:
    """A gear pair on rigid bearings: m delta'' + c(t) delta' + k(t) delta = F + f(t).

    Attributes
    ----------
    pair : the gear pair
    rigid_pair : the pair of the equation: the gear pair on rigid bearings, with rectangular stiffness where
        asked for
    mass : effective mass m [kg], 1/m = r_bp^2/J_p + r_bg^2/J_g
    stiffness : k(t) [N/m], the friction that elastic loads make included
    damping : c(t) [N s/m], the friction that damper forces make included
    multipliers : the two Floquet multipliers over one mesh cycle with proven bounds, in which the errors of
        both polynomials are
    """

    pair: GearPair
    rigid_pair: GearPair
    mass: float
    stiffness: PiecewisePolynomial
    damping: PiecewisePolynomial
    multipliers: GearPairMultipliers
    _equations: LTVSystem = field(repr=False)

    @property
    def period(self) -> float:
        """Mesh cycle T [s]."""
        return self._equations.period

    @cached_property
    def system(self) -> PeriodicSystem:
        """The equation without force as x' = A(t) x for every routine of `floquet`, x = (delta, delta').

        A(t) has the polynomials ``stiffness`` and ``damping``. Bounds on multipliers of this system do not
        have the errors of the polynomials; those of ``multipliers`` do.
        """
        terms = [(self.stiffness * (1.0 / self.mass), np.array([[0.0, 0.0], [-1.0, 0.0]]))]
        if self.damping.rows.any():
            terms.append((self.damping * (1.0 / self.mass), np.array([[0.0, 0.0], [0.0, -1.0]])))
        return PeriodicSystem(PeriodicMatrix(np.array([[0.0, 1.0], [0.0, 0.0]]), *terms), self.period)

    def arm(self, position: npt.ArrayLike) -> FloatArray:
        """Share a of a friction force that acts on delta [-], at positions xi (k,) [m].

        xi is the distance from the tangent point of the pinion. The friction force turns the pinion by the
        arm xi, the gear by the arm L_XY - xi.
        """
        return friction_arm(self._equations, np.atleast_1d(real_array("position", position)))

    def tooth_error_force(self, time: npt.ArrayLike) -> FloatArray:
        """Force f(t) (k,) [N] of the unloaded tooth errors at times (k,) [s].

        f = SUM (1 + mu_i a(xi_i)) (k_i e_i + c_i e_i').
        """
        gain = self._equations.gain(real_array("time", time))
        return np.asarray(self.mass * (gain.error @ self._equations.deflection))

    def motion(self, samples_per_cycle: int = 512) -> xr.Dataset:
        """Periodic motion over one mesh cycle, with teeth that may pull.

        Parameters
        ----------
        samples_per_cycle : output times, 8 to 65536

        Returns
        -------
        xarray.Dataset as of ``lumped.steady_state`` without motions and forces of bearings. The attributes
        carry torques, powers and the efficiency as there, ``force``, the constant F [N] of the torques that
        balance the moments, ``dte_peak_to_peak`` [m] whatever the sampling, ``spectral_radius`` and
        ``error_estimate``

        Raises
        ------
        NumericalError : the speed sits on a stability boundary, where no periodic motion exists
        """
        solution = periodic_solution(self._equations, sample_times(self.period, samples_per_cycle))
        torques = np.array([solution.pinion_torque, solution.brake_torque])
        names = [f"{name}{suffix}" for name in _LEFT_OUT for suffix in ("", "_dot")]
        values = {name: array for name, array in solution.values.items() if name not in names}
        attributes = power_attributes(solution) | {
            "title": f"periodic motion of {self.pair.name} with one degree of freedom",
            "supports": "rigid",
            "contact": "linear",
            "model": "lumped",
            "force": float(torques @ force_by_torques(self._equations)),
            "dte_peak_to_peak": solution.peak_to_peak_of("dte"),
            "spectral_radius": solution.spectral_radius,
            "error_estimate": solution.error,
        }
        origin = _provenance(self.pair, self.rigid_pair, samples_per_cycle=samples_per_cycle)
        return labelled(solution.time, values, origin | attributes)

    def closed_form(
        self, *, friction_load: FrictionLoad = "dynamic", damper_friction: bool = True
    ) -> LinearSegments:
        """The equation with its closed form by Airy functions, for constant |mu| and rectangular stiffness.

        Parameters
        ----------
        friction_load : load that friction is proportional to: "dynamic", the load of each pair in the motion,
            so that friction is part of k(t); or "mean", the constant load T_p/r_bp, shared by the pairs in
            contact in proportion to their stiffness: friction is then a force, and k(t) and the multipliers
            are those without friction
        damper_friction : whether the damper forces of the teeth make friction, as in ``stiffness`` and
            ``damping``. c(t) is then not constant between switches, and no closed form is known: False is
            needed with friction and mesh damping

        Returns
        -------
        LinearSegments, whose force is F of the balanced torques

        Raises
        ------
        ParameterError : a law that is not constant between switches, teeth with errors, friction of damper
            forces, or a damping at or above the critical one; the text says what to change
        """
        one_of("friction_load", friction_load, get_args(FrictionLoad))
        return closed_form(self._equations, self.mass, friction_load, damper_friction)


def single_degree(pair: AnyPair, *, stiffness: Stiffness = "pair", rtol: float = 1e-10) -> SingleDegree:
    """The torsional model of a gear pair with sliding friction: one degree of freedom on rigid bearings.

    The coordinate is the dynamic transmission error. The equation follows from equations (1) and (2) of the
    pair with bearings that do not give. Friction follows the law of the pair, constant or varying along the
    path of contact, with arms that are linear in time. Bearings and shafts of the pair do not enter.

    Parameters
    ----------
    pair : the gear pair, with like teeth
    stiffness : "pair", the stiffness and errors of the teeth as the pair has them; or "rectangular", one
        constant stiffness of every tooth pair from A to D, whose mean over the mesh cycle is that of the
        pair, without errors of the teeth: the model of Vaishya and Singh
    rtol : wanted error of the monodromy matrix relative to its norm, 1e-13 to 1e-1

    Returns
    -------
    SingleDegree

    Raises
    ------
    ParameterError : an unknown stiffness, rtol out of range
    NumericalError : as in `gear_pair_multipliers`

    Examples
    --------
    >>> import floquet, lumped
    >>> pair = lumped.load_gear_pair("fzg_c").with_(law="coulomb", friction__coefficient=0.08)
    >>> model = floquet.single_degree(pair, stiffness="rectangular")
    >>> model.multipliers.verdict
    'stable'

    Just behind the pitch point friction makes the mesh stiffer than just before it, by (1 + mu a)/(1 - mu a):

    >>> g = pair.geometry
    >>> pitch = (g.L_XP - g.L_XA) / g.base_pitch * model.period
    >>> before, behind = model.stiffness([0.999 * pitch, 1.001 * pitch])
    >>> round(float(behind / before), 3)
    1.068
    >>> a = float(model.arm(g.L_XP)[0])
    >>> round((1 + 0.08 * a) / (1 - 0.08 * a), 3)
    1.068

    The motion, and the same in closed form without friction of damper forces:

    >>> motion = model.motion(64)
    >>> closed = model.closed_form(damper_friction=False).motion(motion["time"].to_numpy())
    >>> bool(abs(closed.dte - motion["dte"].to_numpy()).max() < 0.01 * motion.attrs["dte_peak_to_peak"])
    True
    """
    rtol = real_number("rtol", rtol, 1e-13, 0.1)
    pair = load_gear_pair(pair)
    variation = _variation(pair, stiffness)
    block = fitted_block(feedback_system(variation), 1.0, max(0.01 * rtol, 1e-13), [])
    equations = LTVSystem.of(variation.pair, "full", supports="rigid")
    mass = float(block.metric[0])
    times = block.phases * block.period
    k, c = (
        PiecewisePolynomial(times, mass * in_time(gain[:, 0], np.diff(times)))
        for gain in (block.gains.w, block.gains.wd)
    )
    return SingleDegree(
        pair=pair,
        rigid_pair=variation.pair,
        mass=mass,
        stiffness=k,
        damping=c,
        multipliers=gear_pair_multipliers(variation, rtol),
        _equations=equations,
    )


@shows_progress("stability chart")
def single_degree_chart(
    pair: AnyPair,
    axes: Axes | None = None,
    *,
    stiffness: Stiffness = "pair",
    friction_law: str | None = None,
    refine: bool = True,
    prove: bool = False,
    rtol: float = 1e-10,
    store: Literal["all", "radius"] = "radius",
    progress: ProgressRequest = None,
) -> xr.Dataset:
    """Stability chart of `single_degree`, over speed, damping, friction coefficient and the like.

    Parameters
    ----------
    pair : the gear pair
    axes : name -> values as of `stability_chart`, without bearing_stiffness
    stiffness : as of `single_degree`
    friction_law, refine, prove, rtol, store, progress : as of `stability_chart`

    Returns
    -------
    xarray.Dataset as of `stability_chart`, with two multipliers; its attribute ``supports`` is "rigid".
    ``spurcheck.plot`` draws it

    Raises
    ------
    ParameterError : as of `stability_chart`, an unknown stiffness
    NumericalError
        A point fails; the message names it.

    Examples
    --------
    >>> import floquet, lumped
    >>> pair = lumped.load_gear_pair("fzg_c").with_(law="coulomb")
    >>> axes = {"speed_rpm": [20000, 47000], "damping_ratio": [0.01, 0.1], "friction_coefficient": [0, 0.1]}
    >>> chart = floquet.single_degree_chart(pair, axes, stiffness="rectangular")
    >>> chart["verdict"].sel(damping_ratio=0.01, friction_coefficient=0.1).values.tolist()
    [1, -1]
    """
    pair = load_gear_pair(pair)
    if friction_law is not None:
        pair = pair.with_({"friction.law": friction_law})
    variation = _variation(pair, stiffness)
    chart = stability_chart(
        variation,
        axes,
        refine=refine,
        prove=prove,
        rtol=rtol,
        store=store,
        progress=progress,
    )
    title = f"stability chart of {pair.name} with one degree of freedom"
    return chart.assign_attrs(_provenance(pair, variation.pair), title=title)


def _provenance(pair: GearPair, rigid_pair: GearPair, **settings: int) -> dict[str, str]:
    """Attributes about the origin: the parameters are those of the gear pair, the stiffness is that used."""
    return provenance(pair, **settings) | {"stiffness": rigid_pair.stiffness_words}


def _variation(pair: GearPair, stiffness: Stiffness) -> GearVariation:
    """The pair on rigid bearings, with its stiffness or with the rectangular one of the same mean."""
    one_of("stiffness", stiffness, get_args(Stiffness))
    ranges = {
        path: spread for path, spread in pair.uncertainty if path.split(".")[0] not in ("bearings", "shafts")
    }
    bearings = {"pinion": _RIGID, "gear": _RIGID}
    rigid = pair.with_({"shafts": None, "bearings": bearings, "uncertainty": ranges})
    if stiffness == "rectangular":
        rigid = _rectangular(rigid)
    return GearVariation(rigid, supports="rigid")


def _rectangular(pair: GearPair) -> GearPair:
    """The pair with constant stiffness of tooth pairs and the same mean mesh stiffness, without errors."""
    g = pair.geometry
    mean = mean_of_pairs(mesh_elements(pair).stiffness, g.base_pitch)
    rectangular = {"model": "rectangular", "pair_stiffness": mean / g.contact_ratio}
    return pair.with_({
        "mesh.stiffness": rectangular, "mesh.contact": "prescribed", "mesh.relief": "ignored",
    })  # fmt: skip


def in_time(poly: FloatArray, lengths: FloatArray) -> FloatArray:
    """Polynomials (P, d+1) in u from -1 to 1, as polynomials in the time s since the start of each piece.

    u = 2 s/h - 1 with the length h of the piece [s]; lowest power first.
    """
    count = poly.shape[1]
    shifted = np.zeros_like(poly)
    for j in range(count):
        for i in range(j + 1):
            shifted[:, i] += math.comb(j, i) * (-1.0) ** (j - i) * poly[:, j]
    return np.asarray(shifted * (2.0 / lengths[:, None]) ** np.arange(count))

"""Everything the report needs, computed once."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
import xarray as xr

import lumped
import multibody
from floquet.gear.chart_axes import chart_axes, operating_rpm, speed_range, with_point
from floquet.gear.dense_chart import dense_chart
from floquet.gear.margins import StabilityMargins, stability_margins
from floquet.gear.multipliers import GearPairMultipliers, gear_pair_multipliers
from lumped import GearPair, Geometry, NumericalError, ParameterError
from lumped.model.averaged import Mode, modes
from lumped.path_of_contact import friction_profile
from lumped.typing import FloatArray
from validation.cross_check.comparison import CrossCheck, crosscheck
from validation.cross_check.metrics import MeshOrders, mesh_orders
from validation.reporting.mesh_physics import MeshPhysics, mesh_physics
from validation.reporting.paper_results import PaperResults, paper_results
from validation.validity.flag import Flag
from validation.validity.flags import speed_drift, validity_flags
from validation.validity.map import validity_map
from validation.verification import (
    Check,
    OrderCheck,
    Refinement,
    code_checks,
    enough_samples,
    order_checks,
    refinements,
)

Progress = Callable[[float, str], None]

_DISPLACEMENTS = ("dte", "x_p", "x_g", "y_p", "y_g")
_ORDERS = 10


@dataclass(frozen=True)
class Effort:
    """How finely the report samples.

    Attributes
    ----------
    samples : per mesh cycle of the periodic motion; at least, with ``verify``
    cycles : of the cross-check
    sweep_speeds : of the response over speed
    chart_speeds, chart_dampings : nodes of the stability chart
    chart_rtol : accuracy of the monodromy matrices in the chart
    map_speeds, map_torques : points of the validity map
    mesh_optimum : whether to search the best tip relief and solve the periodic motion of every law
    attribution : whether to switch the finite-motion effects one at a time, to say why the models differ
    verify : whether to check the code against closed forms and to refine the solutions
    paper : whether to reproduce the paper's figures, judge its claims and show its errata with this pair
    claim_samples : samples of what the paper leaves open, for that
    """

    samples: int
    cycles: int
    sweep_speeds: int
    chart_speeds: int
    chart_dampings: int
    chart_rtol: float
    map_speeds: int = 7
    map_torques: int = 3
    mesh_optimum: bool = False
    attribution: bool = False
    verify: bool = False
    paper: bool = False
    claim_samples: int = 8


FULL = Effort(
    samples=512,
    cycles=40,
    sweep_speeds=240,
    chart_speeds=401,
    chart_dampings=81,
    chart_rtol=1e-8,
    map_speeds=31,
    map_torques=9,
    mesh_optimum=True,
    attribution=True,
    verify=True,
    claim_samples=100,
)
QUICK = Effort(samples=128, cycles=16, sweep_speeds=24, chart_speeds=16, chart_dampings=4, chart_rtol=1e-6)


@dataclass(frozen=True)
class Verification:
    """Code and solution verification, see ``validation.verification``."""

    code: tuple[Check, ...]
    orders: tuple[OrderCheck, ...]
    solution: tuple[Refinement, ...]


@dataclass(frozen=True, eq=False)
class Results:
    """Results of one gear pair, from which the chapters are written."""

    pair: GearPair
    geometry: Geometry
    effort: Effort
    profile: xr.Dataset
    mesh: MeshPhysics
    motion: xr.Dataset
    orders: Mapping[str, MeshOrders]
    modes: tuple[Mode, ...]
    sweep: xr.Dataset
    check: CrossCheck
    causes: xr.Dataset | None
    multipliers: GearPairMultipliers
    chart: xr.Dataset
    flags: tuple[Flag, ...]
    margins: StabilityMargins
    validity: xr.Dataset
    verification: Verification | None
    paper: PaperResults | None
    paper_refusal: str = ""

    @property
    def operating_rpm(self) -> float:
        """Pinion speed [rpm]."""
        return operating_rpm(self.pair)

    @property
    def static_load(self) -> float:
        """Normal load of all pairs at rest, T_p/r_bp [N]."""
        return self.pair.operating.pinion_torque / self.geometry.base_radius_pinion


def compute(pair: GearPair, effort: Effort, progress: Progress) -> Results:
    """Compute everything for one pair.

    Parameters
    ----------
    pair : the gear pair
    effort : how finely
    progress : called with the finished fraction and what is being done

    Raises
    ------
    NumericalError : a model fails; the text says what to try
    """
    progress(0.0, "periodic motion")
    samples = enough_samples(pair, effort.samples) if effort.verify else effort.samples
    motion = lumped.steady_state(pair, samples_per_cycle=samples)
    orders = {n: mesh_orders(motion[n].to_numpy(), samples, _ORDERS) for n in _DISPLACEMENTS}
    profile = friction_profile(pair)
    try:
        found = modes(pair)
    except NumericalError:  # an overdamped mode has no natural frequency; the report says so
        found = ()
    speeds = speed_range(pair, found)
    progress(0.05, "response over speed")
    sweep = lumped.speed_sweep(
        pair,
        np.linspace(*speeds, effort.sweep_speeds),
        samples_per_cycle=128,
        progress=lambda f: progress(0.05 + 0.15 * f, "response over speed"),
    )
    check = crosscheck(
        pair,
        cycles=effort.cycles,
        progress=lambda f: progress(0.2 + 0.25 * f, "cross-check against the multibody model"),
    )
    causes = _causes(pair) if effort.attribution else None
    progress(0.45, "stability")
    multipliers = gear_pair_multipliers(pair)
    chart = dense_chart(
        pair,
        chart_axes(pair, effort.chart_speeds, effort.chart_dampings),
        rtol=effort.chart_rtol,
        progress=lambda f: progress(0.45 + 0.15 * f, "stability chart"),
    )
    progress(0.6, "stability margins")
    margins = stability_margins(pair, speeds)
    valid = validity_map(
        pair,
        *map_axes(pair, speeds, effort),
        progress=lambda f: progress(0.65 + 0.1 * f, "validity over speed and torque"),
    )
    verification = None
    if effort.verify:
        progress(0.75, "verification")
        verification = Verification(code_checks(pair), order_checks(), refinements(pair, samples))
    reproduced, refusal = None, ""
    if effort.paper:
        try:
            reproduced = paper_results(
                pair, effort.claim_samples, lambda f: progress(0.8 + 0.18 * f, "comparison with the paper")
            )
        except (NumericalError, ParameterError) as error:  # the paper's operating points may not suit a pair
            refusal = str(error)
    g = pair.geometry
    flags = validity_flags(pair, motion, multipliers)
    flags += (speed_drift(g, check.multibody["linear"]),)
    return Results(
        pair=pair,
        geometry=g,
        effort=effort,
        profile=profile,
        mesh=mesh_physics(pair, motion, profile, quick=not effort.mesh_optimum),
        motion=motion,
        orders=orders,
        modes=found,
        sweep=sweep,
        check=check,
        causes=causes,
        multipliers=multipliers,
        chart=chart,
        flags=flags,
        margins=margins,
        validity=valid,
        verification=verification,
        paper=reproduced,
        paper_refusal=refusal,
    )


def _causes(pair: GearPair) -> xr.Dataset | None:
    """Why the exact model differs; None where it has no periodic motion near the lumped one."""
    try:
        return multibody.attribution(pair, periodic=True)
    except NumericalError:
        return None


def map_axes(pair: GearPair, speeds: tuple[float, float], effort: Effort) -> tuple[FloatArray, FloatArray]:
    """Speeds [rpm] and torques [N m] of the validity map; the operating point is a node."""
    torque = pair.operating.pinion_torque
    return (
        with_point(np.linspace(*speeds, effort.map_speeds), operating_rpm(pair)),
        with_point(torque * np.geomspace(0.2, 4.0, effort.map_torques), torque),
    )

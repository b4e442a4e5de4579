"""Results that several chapters of the report share, each computed when it is first asked for."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, partial
from typing import TypeVar

import numpy as np
import xarray as xr

import lumped
from floquet.gear.axes import operating_rpm, speed_range
from floquet.gear.multipliers import GearPairMultipliers, gear_pair_multipliers
from floquet.gear.orbit import GearOrbit, periodic_orbit
from floquet.gear.response import ResponseBranches
from floquet.gear.tongues import StabilityMargins, stability_margins
from lumped import GearPair, Geometry, NumericalError, ParameterError
from lumped.model.averaged import Mode, modes
from lumped.model.results import cycle_peak_to_peak
from lumped.model.sweep import resolved_sweep
from lumped.path_of_contact import friction_profile
from lumped.typing import BoolArray, Progress
from validation.cross_check.comparison import CrossCheck, crosscheck
from validation.reporting.cross_check_words import attribution
from validation.validity.beyond_contact_loss import branches_about_operation, jumps_about_operation
from validation.validity.contact_forms import ContactForms, contact_forms
from validation.validity.flags import LOAD_NOISE, Flag, speed_drift, supports, validity_flags
from validation.validity.four_springs import FourSprings, four_springs
from validation.validity.plausibility import doubts
from validation.verification.checks import Check, on_shafts
from validation.verification.tooth_stiffness import ToothStiffness, tooth_stiffness

T = TypeVar("T")


@dataclass(frozen=True)
class Effort:
    """How finely the report samples.

    Attributes
    ----------
    samples : per mesh cycle of the periodic motion
    cycles : of the cross-check
    sweep_speeds : of the response over speed, at most
    chart_speeds, chart_dampings : nodes of the stability chart
    chart_rtol : accuracy of the monodromy matrices in the chart
    map_speeds, map_torques : points of the validity map
    shaft_speeds : at which four springs are compared with shafts
    full : whether to search the best tip relief, to solve the periodic motion of every law, to switch the
        finite-motion effects one at a time, and to refine solutions
    """

    samples: int
    cycles: int
    sweep_speeds: int
    chart_speeds: int
    chart_dampings: int
    chart_rtol: float
    map_speeds: int
    map_torques: int
    shaft_speeds: int
    full: bool


FULL = Effort(512, 6, 240, 121, 17, 1e-6, 15, 5, 41, full=True)
QUICK = Effort(128, 16, 48, 16, 4, 1e-6, 7, 3, 13, full=False)


@dataclass(frozen=True, eq=False)
class ContactLoss:
    """What the pair does where the linear motion has negative tooth loads.

    Attributes
    ----------
    orbit : the same equations with unilateral contact
    exact : a mesh cycle of the multibody model
    exact_peak_to_peak : its transmission error [m]
    judged : whether the cross-check compares these two
    """

    orbit: GearOrbit
    exact: xr.Dataset
    exact_peak_to_peak: float
    judged: bool


class Results:
    """Shared results of one gear pair.

    Parameters
    ----------
    pair : the gear pair
    effort : how finely
    progress : called with the finished fraction of the present computation and its name

    Raises
    ------
    NumericalError : from whichever result a model cannot compute; the text says what to try
    """

    def __init__(self, pair: GearPair, effort: Effort, progress: Progress | None = None) -> None:
        self.pair = pair
        self.effort = effort
        self.progress: Progress = progress or (lambda fraction, stage="", /: None)

    def stage(self, name: str) -> Progress:
        """Progress of one computation: tells its name at once, and takes its finished fraction."""
        self.progress(0.0, name)
        return lambda fraction, _="", /: self.progress(fraction, name)

    @property
    def geometry(self) -> Geometry:
        """Geometry of the pair."""
        return self.pair.geometry

    @property
    def operating_rpm(self) -> float:
        """Pinion speed [rpm]."""
        return operating_rpm(self.pair)

    @property
    def static_load(self) -> float:
        """Normal load of all pairs at rest, T_p/r_bp [N]."""
        return self.pair.operating.pinion_torque / self.geometry.base_radius_pinion

    @cached_property
    def motion(self) -> xr.Dataset:
        """Periodic motion at the operating point."""
        self.stage("periodic motion")
        return lumped.steady_state(self.pair, samples_per_cycle=self.effort.samples)

    @cached_property
    def profile(self) -> xr.Dataset:
        """Contact conditions and every friction law along the path of contact."""
        return friction_profile(self.pair)

    @cached_property
    def modes(self) -> tuple[Mode, ...]:
        """Modes of the averaged pair; empty where one is overdamped and has no natural frequency."""
        try:
            return modes(self.pair)
        except NumericalError:
            return ()

    @cached_property
    def speeds(self) -> tuple[float, float]:
        """Range of pinion speeds of everything over speed [rpm]."""
        return speed_range(self.pair)

    @cached_property
    def sweep(self) -> xr.Dataset:
        """Periodic motion over speed."""
        return resolved_sweep(
            self.pair,
            self.speeds,
            most=self.effort.sweep_speeds,
            samples_per_cycle=128,
            progress=self.stage("response over speed"),
        )

    @cached_property
    def doubts(self) -> tuple[str, ...]:
        """Sentences on given values that hardly can be meant."""
        return doubts(self.pair)

    @property
    def separating_share(self) -> float:
        """Share of the range of speeds with negative tooth loads."""
        low = self.sweep["normal_load_min"].to_numpy()  # NaN where there is no periodic motion
        return self.share_of_range(low < -LOAD_NOISE * self.static_load)

    def share_of_range(self, where: BoolArray) -> float:
        """Share of the range of speeds taken by the speeds of the sweep that are marked."""
        speed = self.sweep["speed"].to_numpy()
        return float(np.trapezoid(where.astype(float), speed) / (speed[-1] - speed[0]))

    @cached_property
    def check(self) -> CrossCheck:
        """Cross-check against the multibody model."""
        stage = self.stage("cross-check against the multibody model")
        return crosscheck(self.pair, cycles=self.effort.cycles, progress=stage)

    @cached_property
    def attribution(self) -> xr.Dataset | None:
        """Effects of the exact model one by one; None where contact is lost or it has no periodic motion."""
        self.stage("effects of the exact model")
        return attribution(self.check)

    @cached_property
    def contact_loss(self) -> ContactLoss | str | None:
        """The motion with unilateral contact.

        None: contact is never lost. A string: the computation failed, with the reason.
        """
        loads = self.motion["normal_load"].where(self.motion["contact"] > 0)
        if float(loads.min()) >= -LOAD_NOISE * self.static_load:
            return None
        orbit = self.check.orbit
        try:
            orbit = orbit or periodic_orbit(self.pair)
        except NumericalError as error:
            return str(error)
        run = self.check.multibody["exact"]
        exact = run.sel(time=slice(float(run["time"][-1]) - 1.000001 * self.geometry.mesh_period, None))
        return ContactLoss(orbit, exact, cycle_peak_to_peak(exact, "dte"), self.check.orbit is not None)

    @cached_property
    def branches(self) -> ResponseBranches | str | None:
        """Motions with unilateral contact about the operating speed.

        None: contact is never lost in the range of speeds, or a quick report. A string: the computation
        failed, with the reason.
        """
        if not self.effort.full or not self.separating_share:
            return None
        return branches_about_operation(self.pair, progress=self.stage("motions beyond contact loss"))

    @cached_property
    def jump_map(self) -> xr.Dataset | str | None:
        """Where the pair can jump over speed and torque; a string or None as for ``branches``."""
        if self.branches is None:
            return None
        return jumps_about_operation(self.pair, progress=self.stage("jumps over speed and torque"))

    @cached_property
    def forms(self) -> ContactForms | str:
        """Both forms of the contact and the exact one; why they cannot be computed."""
        self.stage("forms of the contact")
        check, exact = self.check, None
        samples = check.lumped.sizes["time"] // check.cycles
        if self.pair.mesh.contact == "loaded" and check.periodic:
            exact = check.multibody["exact"].isel(time=slice(samples))
        return _or_why_not(partial(contact_forms, samples=samples, exact=exact), self.pair)

    @cached_property
    def lifting(self) -> xr.Dataset | None:
        """The motion with unilateral contact, where a pair pulls but the total load is positive."""
        found, forms = self.contact_loss, self.forms
        if (
            not isinstance(found, ContactLoss)
            or found.judged
            or isinstance(forms, str)
            or forms.own == "prescribed"
        ):
            return None
        return found.orbit.sampled(forms.motions["exact"].sizes["time"])

    @cached_property
    def multipliers(self) -> GearPairMultipliers:
        """Floquet multipliers at the operating point."""
        return gear_pair_multipliers(self.pair)

    @cached_property
    def tooth_stiffness(self) -> ToothStiffness | str:
        """Tooth stiffness beside plane elasticity; why it cannot be computed."""
        self.stage("tooth stiffness by elasticity")
        return _or_why_not(tooth_stiffness, self.pair)

    @property
    def checks(self) -> tuple[Check, ...]:
        """Checks of the tooth stiffness and of the pair on its shafts, which every report has."""
        found = self.tooth_stiffness
        return (*(() if isinstance(found, str) else found.checks), *self.on_shafts)

    @cached_property
    def on_shafts(self) -> tuple[Check, ...]:
        """The machine against the model on shafts; empty without shafts."""
        return tuple(on_shafts(self.pair))

    @cached_property
    def margins(self) -> StabilityMargins:
        """Tongues of instability over the range of speeds, and the distances to them."""
        self.stage("stability margins")
        return stability_margins(self.pair, self.speeds)

    @cached_property
    def flags(self) -> tuple[Flag, ...]:
        """Assumptions of the lumped model, checked at the operating point."""
        found = [*validity_flags(self.pair, self.motion, self.multipliers)]
        found.append(speed_drift(self.geometry, self.check.multibody["linear"]))
        if isinstance(self.four_springs, FourSprings):
            found.append(supports(self.four_springs))
        return tuple(found)

    @cached_property
    def four_springs(self) -> FourSprings | str | None:
        """The pair on its shafts beside four springs; why it cannot be computed; None without shafts."""
        if self.pair.shafts is None:
            return None
        speeds = np.linspace(*self.speeds, self.effort.shaft_speeds)
        stage = self.stage("the pair on its shafts")
        return _or_why_not(partial(four_springs, speeds_rpm=speeds, progress=stage), self.pair)


def _or_why_not(compute: Callable[[GearPair], T], pair: GearPair) -> T | str:
    """What is computed of the pair, or the text of why it cannot be."""
    try:
        return compute(pair)
    except (NumericalError, ParameterError) as error:
        return str(error)

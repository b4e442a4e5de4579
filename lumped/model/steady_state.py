"""The periodic motion of a pair: over one mesh cycle, or over the period of teeth that differ.

Sources: docs/theory/equations.md, "Periodic motion and the brake torque"; docs/theory/teeth.md.
"""

from __future__ import annotations

from collections.abc import Collection
from functools import partial
from typing import TYPE_CHECKING

from lumped.arguments import some_of, whole_number
from lumped.errors import refuse
from lumped.labelling import provenance
from lumped.model.cycle_maps import linear_motion
from lumped.model.equations import PRINTED_EQUATIONS
from lumped.model.linear_or_unilateral import ContactArgument, MotionForm, motion_form
from lumped.model.neighbouring_motion import unilateral_or_followed_motion
from lumped.model.periodic_system import Supports, supports_of
from lumped.model.results import PlainMotion
from lumped.model.revolution_motion import default_samples, plain_motion
from lumped.model.solution import steady_cycle
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.schema.meeting_teeth import period_of
from lumped.schema.pair import GearPair
from lumped.typing import Progress, unheard

if TYPE_CHECKING:
    import xarray as xr


def steady_state(
    pair: AnyPair,
    *,
    contact: ContactArgument = "linear",
    supports: Supports | None = None,
    samples_per_cycle: int | None = None,
    as_printed: Collection[int] = (),
) -> xr.Dataset:
    """Periodic motion over one mesh cycle without settling, or over the whole period of teeth that differ.

    Teeth differ by deviations, an eccentric mounting or faults; a ripple of a torque has a period of its own
    too. Then the motion is that over a revolution or the hunting period, see ``revolution``, and every
    meeting pair has its own gap, tip corners and stiffness. What ``contact`` says holds for teeth that are
    alike and that differ.

    Parameters
    ----------
    pair : a validated gear pair
    contact : "linear", about the static state of every pair (with prescribed contact: in its fixed windows),
        in which teeth may pull: the form that stability charts rest on; or "unilateral", by momentary load:
        teeth only push
    supports : "springs", the four of ``bearings``, or "shafts", the elastic ones of ``shafts``; by default
        the shafts of a pair that has them. On these ``bearing_force`` over ``bearing`` and ``direction`` is
        the force of each bearing on its shaft, and ``power_shafts`` what the shafts' damping takes [W]
    samples_per_cycle : output times in each mesh cycle; default 512, fewer where the period has many cycles
    as_printed : equations out of 1, 2, 7, 9 whose printed sign is used; of linear contact and like teeth

    Returns
    -------
    xarray.Dataset as of ``simulate`` over the period; the attributes carry ``brake_torque`` and
    ``pinion_torque`` [N m] that hold the mean speed, the mean losses ``power_sliding``,
    ``power_tooth_dampers`` and ``power_bearings`` [W], ``mesh_efficiency``, one less all losses over the
    driving power, ``power_energy_residual``, what of the losses no torque balances with prescribed contact
    [W], ``error_estimate``, the relative error of the dynamic transmission error, ``dte_peak_to_peak`` [m],
    its peak to peak whatever the sampling (and so for the translations), ``spectral_radius``, the largest
    modulus of the Floquet multipliers (above 1 the motion is unstable, and a pair leaves it; of teeth that
    differ it is that of the twin with like teeth), ``contact`` and ``supports``.
    With unilateral contact or teeth that differ also ``period_cycles`` [mesh cycles], after which the motion
    repeats, ``touch``, in words how the teeth touch, and ``error_estimate`` is the difference to longer
    steps; with unilateral contact ``origin`` says how the motion was found. Of teeth that differ
    ``pinion_tooth`` and ``gear_tooth`` are those of each ``pair`` and time, counted from 1

    Raises
    ------
    ParameterError : arguments out of range
    NumericalError : the speed sits on a stability boundary, where no periodic motion exists; with unilateral
        contact no run settles to a motion that repeats; teeth that differ have no motion with their period,
        or one that settles too slowly
    """
    pair = load_gear_pair(pair)
    return periodic_motion(pair, contact, supports, samples_per_cycle, as_printed).dataset


def periodic_motion(
    pair: GearPair,
    contact: ContactArgument = "linear",
    supports: Supports | None = None,
    samples_per_cycle: int | None = None,
    as_printed: Collection[int] = (),
    progress: Progress = unheard,
) -> PlainMotion:
    """Return the motion of ``steady_state``, which has the same arguments and errors, as plain arrays.

    ``progress`` is called with the finished fraction and what is being done, of a unilateral motion.
    """
    form = motion_form(pair, contact)
    supports = supports_of(pair, supports)
    if samples_per_cycle is not None:
        samples_per_cycle = whole_number("samples_per_cycle", samples_per_cycle, 8, 65536)
    check_printed(pair, contact, as_printed)
    if form is MotionForm.LINEAR_LIKE_TEETH:
        samples = 512 if samples_per_cycle is None else samples_per_cycle
        return steady_cycle(pair, samples, as_printed, supports)
    count = default_samples(period_of(pair)) if samples_per_cycle is None else samples_per_cycle
    if form is MotionForm.LINEAR_OWN_TEETH:
        motion = linear_motion(pair, count, supports)
    else:
        motion = unilateral_or_followed_motion(pair, count, supports, progress)
    return plain_motion(motion, partial(provenance, pair, samples_per_cycle=count, contact=contact))


def check_printed(pair: AnyPair, contact: ContactArgument, as_printed: Collection[int]) -> None:
    """Refuse printed signs where the equations are not those of the publication."""
    pair = load_gear_pair(pair)
    printed = motion_form(pair, contact) is MotionForm.LINEAR_LIKE_TEETH
    if not printed and some_of("as_printed", as_printed, PRINTED_EQUATIONS):
        allowed = "() with unilateral contact, and where teeth differ"
        raise refuse("as_printed", list(as_printed), allowed, "Use contact='linear' and pair.healthy.")

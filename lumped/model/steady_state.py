"""The periodic motion of a pair: over one mesh cycle, or over the period of teeth that differ.

Sources: docs/theory/equations.md, "Periodic motion and the brake torque"; docs/theory/teeth.md.
"""

from __future__ import annotations

from collections.abc import Collection
from typing import TYPE_CHECKING, Literal

from lumped.arguments import one_of, whole_number
from lumped.errors import refuse
from lumped.labelling import provenance
from lumped.model.cycle_maps import linear_motion
from lumped.model.momentary_load import settled_motion
from lumped.model.periodic_system import Supports
from lumped.model.revolution_motion import default_samples, labelled_motion
from lumped.model.solution import steady_cycle
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.schema.meeting_teeth import period_of

if TYPE_CHECKING:
    import xarray as xr

#: How the teeth touch in the motion over a period of teeth that differ.
Touch = Literal["unilateral", "linear"]


def steady_state(
    pair: AnyPair,
    *,
    samples_per_cycle: int | None = None,
    as_printed: Collection[int] = (),
    supports: Supports = "springs",
    touch: Touch = "unilateral",
) -> xr.Dataset:
    """Periodic motion over one mesh cycle without settling, or over the whole period of teeth that differ.

    Teeth differ by deviations, an eccentric mounting or faults; a ripple of a torque has a period of its own
    too. Then the motion is that over a revolution or the hunting period, see ``revolution``: every meeting
    pair has unilateral contact with its own gap, tip corners and stiffness. It is settled from
    the motion of like teeth; the linear form is closed over the period by the maps of its mesh cycles.

    Parameters
    ----------
    pair : a validated gear pair
    samples_per_cycle : output times in each mesh cycle; default 512, fewer where the period has many cycles
    as_printed : equations out of 1, 2, 7, 9 whose printed sign is used; of like teeth alone
    supports : "springs", the four of ``bearings``, or "shafts", the elastic ones of ``shafts``; then
        ``bearing_force`` over ``bearing`` and ``direction`` is the force of each bearing on its shaft, and
        ``power_shafts`` what the shafts' damping takes [W]
    touch : of teeth that differ: "unilateral", or "linear", the linear form about the own static state of
        every pair (with prescribed contact: in its fixed windows), which stability and sweeps rest on

    Returns
    -------
    xarray.Dataset as of ``simulate`` over the period; the attributes carry ``brake_torque`` and
    ``pinion_torque`` [N m] that hold the mean speed, ``mesh_efficiency`` = T_g Omega_g / (T_p Omega_p),
    the mean losses ``power_sliding``, ``power_tooth_dampers`` and ``power_bearings`` [W],
    ``power_energy_residual``, what of them no torque balances with prescribed contact [W],
    ``error_estimate``, the relative error of the dynamic transmission error, ``dte_peak_to_peak`` [m], its
    peak to peak whatever the sampling (and so for the translations), and ``spectral_radius``, the
    largest modulus of the Floquet multipliers: above 1 the motion is unstable, and a pair leaves it.
    Of teeth that differ also ``pinion_tooth`` and ``gear_tooth`` of each ``pair`` and time, counted from 1,
    and the attributes ``period_cycles`` [mesh cycles] and ``touch``, the form of contact that was used;
    ``error_estimate`` is then the difference to longer steps, and ``spectral_radius`` that of
    the twin with like teeth

    Raises
    ------
    NumericalError : the speed sits on a stability boundary, where no periodic motion exists; teeth that
        differ have no motion with their period, or one that settles too slowly
    """
    pair = load_gear_pair(pair)
    if samples_per_cycle is not None:
        samples_per_cycle = whole_number("samples_per_cycle", samples_per_cycle, 8, 65536)
    if pair.healthy is pair:
        return steady_cycle(
            pair, 512 if samples_per_cycle is None else samples_per_cycle, as_printed, supports
        )
    if as_printed:
        raise refuse("as_printed", list(as_printed), "() where teeth differ", "Use pair.healthy.")
    one_of("touch", touch, ("unilateral", "linear"))
    cycles = period_of(pair)
    count = default_samples(cycles) if samples_per_cycle is None else samples_per_cycle
    motion = (linear_motion if touch == "linear" else settled_motion)(pair, count, supports)
    return labelled_motion(motion, provenance(pair, samples_per_cycle=count, touch=touch))

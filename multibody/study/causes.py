"""Why the exact model differs from the lumped model: finite-motion effects, switched one at a time.

Sources: docs/theory/multibody.md, "Effects".
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from lumped.display.progress import reported_to, shows_progress
from lumped.errors import NumericalError
from lumped.labelling import labelled_dataset, provenance
from lumped.model.periodic_system import Supports, supports_of
from lumped.model.results import needs_pull
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.typing import ProgressRequest
from multibody.run.effects import CAUSES, EFFECTS, default_effects, form_of
from multibody.run.flow_map import Orbit, cycles_of, find_orbit
from multibody.run.setup import prepare

if TYPE_CHECKING:
    import xarray as xr

_SAMPLES = 128
#: Relative tolerance of the runs. The shares have an error of this size.
_RTOL = 1e-7
_QUANTITIES = ("dte", "x_p", "y_p", "theta_p")
_KINDS = {"alone": "by this cause", "without": "all causes but this"}


@shows_progress("causes of the difference")
def attribution(
    pair: AnyPair, *, supports: Supports | None = None, progress: ProgressRequest = None
) -> xr.Dataset:
    """How much each finite-motion effect changes the periodic motion, and the momentary load in friction.

    Each motion has the brake torque that balances this motion. In runs from one state every effect that
    changes the losses would also let the speed of the pair drift, and the phase with the speed.

    Parameters
    ----------
    pair : a validated gear pair
    supports : "springs" or "shafts", as of ``multibody.simulate``; by default shafts for a pair with shafts
    progress : True (a bar), False (none), None (a bar where the call takes over two seconds), or a function
        that is called with the finished fraction

    Returns
    -------
    xarray.Dataset over ``cause`` and ``quantity``: ``alone``, the largest change by one cause, and
    ``without``, the largest change when all causes but this cause act. Both are over the peak to peak of the
    motion without effects. Cause "all" is the whole difference from the lumped model, by all effects that act
    by default. The attribute ``largest`` names the cause with the largest change of the transmission error.
    "friction_load" is below "all", because this cause is no part of the difference. A quantity that does not
    move without effects (y_p without friction) is NaN.

    Every exact motion includes "contact": unilateral contact of the actual flanks.
    ``alone`` of another cause is the change of the motion with "contact". The ``without`` of "contact" is
    NaN, because teeth would then pull over a gap.

    Raises
    ------
    NumericalError : the lumped motion needs teeth that pull, or a motion is not found
    """
    progress = reported_to(progress)
    pair = load_gear_pair(pair)
    supports = supports_of(pair, supports)
    orbits: dict[frozenset[str], tuple[Orbit, xr.Dataset]] = {}

    def motion(effects: set[str], near: set[str] | None = None) -> xr.Dataset:
        """Motion with these effects. The search starts from the motion with the effects ``near``."""
        names = frozenset(effects)
        if names not in orbits:
            start = None if near is None else orbits[frozenset(near)][0]
            setup = prepare(pair, "exact", "periodic", effects, _RTOL, supports=supports)
            orbit = find_orbit(setup, near=start)
            orbits[names] = orbit, cycles_of(orbit, _SAMPLES)
        return orbits[names][1]

    every = set(default_effects(form_of(pair)))
    groups = {cause: {name for name in EFFECTS if EFFECTS[name].cause == cause} for cause in CAUSES}
    contact = groups["contact"] & every
    parts = {cause: names & every for cause, names in groups.items() if names & every}
    asked_for = {
        cause: names for cause, names in groups.items() if not any(EFFECTS[name].forms for name in names)
    }
    groups = parts | {"all": every} | asked_for
    base = motion(set())
    if needs_pull(pair, base):
        raise NumericalError(
            "The lumped motion needs teeth that pull, so differences from it have no cause. "
            "Raise the torque or the damping, or change the speed."
        )
    touching = motion(contact, set())
    motion(every, contact)
    table = {kind: np.full((len(groups), len(_QUANTITIES)), np.nan) for kind in _KINDS}
    for row, (cause, names) in enumerate(groups.items()):
        start = base if contact <= names else touching
        runs = {"alone": (motion(contact | names, contact), start)}
        if names <= every - contact or cause == "all":
            runs["without"] = (motion(every - names, every), base)
        for kind, (run, reference) in runs.items():
            for column, name in enumerate(_QUANTITIES):
                swing = float(np.ptp(base[name].to_numpy()))
                change = float(np.abs(run[name] - reference[name]).max())
                table[kind][row, column] = change / swing if swing > 0.0 else np.nan
        if progress is not None:
            progress((row + 1) / len(groups))
    return labelled_dataset(
        {
            kind: (("cause", "quantity"), table[kind], "1", f"largest change over peak to peak, {text}")
            for kind, text in _KINDS.items()
        },
        {
            "cause": (list(groups), "1", "cause of the difference"),
            "quantity": (list(_QUANTITIES), "1", "quantity that changes"),
        },
        provenance(pair, samples_per_cycle=_SAMPLES)
        | {"supports": supports, "largest": list(parts)[int(np.nanargmax(table["alone"][: len(parts), 0]))]},
    )

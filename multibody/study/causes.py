"""Why the exact model differs from the lumped one: its finite-motion effects, switched one at a time.

Sources: docs/theory/multibody.md, "Effects".
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from typing import TYPE_CHECKING

import numpy as np

from lumped.model.results import provenance
from lumped.model.solution import Initial
from lumped.schema.pair import GearPair
from multibody.contact.effects import EFFECTS
from multibody.run.flow_map import steady_state
from multibody.run.simulation import simulate

if TYPE_CHECKING:
    import xarray as xr

#: Rotations and centres together place the contact; one without the other is no motion of the machine, so the
#: two switches count as one cause.
CAUSES: dict[str, tuple[str, ...]] = {
    "contact_position": ("rotation_phase", "moving_line"),
    "sliding_velocity": ("sliding_velocity",),
    "entry_shift": ("entry_shift",),
    "contact_loss": ("contact_loss",),
}
_QUANTITIES = ("dte", "x_p", "y_p", "theta_p")


def attribution(
    pair: GearPair,
    cycles: int = 20,
    *,
    initial: Initial = "periodic",
    samples_per_cycle: int = 128,
    rtol: float = 1e-9,
    periodic: bool = False,
    progress: Callable[[float], None] | None = None,
) -> xr.Dataset:
    """How much each finite-motion effect changes the motion.

    Parameters
    ----------
    pair : a validated gear pair
    cycles, initial, samples_per_cycle, rtol : of the runs, as ``multibody.simulate``
    periodic : compare periodic motions instead, each with the brake torque that balances it
        (``multibody.steady_state``; ``cycles`` and ``initial`` have no meaning then). In a run every effect
        that changes the losses also lets the pair drift, which adds a shift of phase that grows with time
    progress : called with the finished fraction

    Returns
    -------
    xarray.Dataset over ``cause`` and ``quantity``: ``alone``, the largest change when only this cause acts,
    and ``without``, the largest change when all causes but this one act; both over the peak to peak of the
    motion without any, so they are shares of the difference from the lumped model. Cause "all" is the whole
    difference; the attribute ``largest`` names the cause that changes the transmission error most. A
    quantity that does not move without effects (y_p without friction) is NaN.
    """
    import xarray as xr

    every = set(EFFECTS)
    cases: dict[tuple[str, str], set[str]] = {("all", "alone"): every, ("all", "without"): set()}
    for cause, names in CAUSES.items():
        cases[cause, "alone"], cases[cause, "without"] = set(names), every - set(names)
    options = {"initial": initial, "samples_per_cycle": samples_per_cycle, "rtol": rtol}

    def motion(effects: Collection[str]) -> xr.Dataset:
        if periodic:
            return steady_state(pair, effects=effects, samples_per_cycle=samples_per_cycle, rtol=rtol)
        return simulate(pair, cycles, effects=effects, **options)  # type: ignore[arg-type]  # mixed types

    base = motion(())
    labels = [*CAUSES, "all"]
    table = {kind: np.zeros((len(labels), len(_QUANTITIES))) for kind in ("alone", "without")}
    for number, ((cause, kind), effects) in enumerate(cases.items()):
        run = motion(effects)
        for column, name in enumerate(_QUANTITIES):
            swing = float(np.ptp(base[name].to_numpy()))
            change = float(np.abs(run[name] - base[name]).max())
            table[kind][labels.index(cause), column] = change / swing if swing > 0.0 else np.nan
        if progress is not None:
            progress((number + 1) / len(cases))
    result = xr.Dataset(
        {
            kind: xr.DataArray(
                values,
                dims=("cause", "quantity"),
                attrs={"units": "1", "long_name": f"largest change over peak to peak, {text}"},
            )
            for (kind, values), text in zip(
                table.items(), ("this cause alone", "all causes but this"), strict=True
            )
        },
        coords={"cause": labels, "quantity": list(_QUANTITIES)},
        attrs=provenance(pair, cycles=1 if periodic else cycles, periodic=periodic, **options),
    )
    result.attrs["largest"] = labels[int(np.argmax(table["alone"][:-1, 0]))]
    return result

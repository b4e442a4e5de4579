"""The cross-check of teeth that differ: both models over a revolution, or over cycles round the worst tooth.

Sources: docs/theory/teeth.md, "In the multibody model".
"""

from __future__ import annotations

import numpy as np
import xarray as xr

import lumped
from lumped import GearPair
from lumped.model.equations import COORDINATES
from lumped.model.periodic_system import LTVSystem
from lumped.schema.bodies import bodies_of
from lumped.teeth.contact import Laws, tables
from lumped.teeth.motion import default_samples, swinging
from lumped.teeth.pairs import period_of
from lumped.typing import FloatArray
from multibody.run.setup import prepare
from multibody.run.simulation import record

#: Longest period that is compared as a whole, cycles of a window, and cycles in which a start is forgotten.
_WHOLE, _WINDOW, _FORGOTTEN = 64, 6, 10


def worst_cycle(pair: GearPair) -> int:
    """Mesh cycle with the largest static load of a tooth in the period."""
    sharing = lumped.static_sharing(pair, samples_per_cycle=32)
    return int(sharing["normal_load"].to_numpy().max(axis=0).argmax()) // 32


def both_motions(pair: GearPair, samples: int) -> tuple[GearPair, xr.Dataset, xr.Dataset]:
    """Lumped and multibody motion of the same cycles at the same times.

    Returned first is the pair whose teeth are counted from the first of the cycles that are run: the
    multibody model starts from the lumped motion, and the first cycles are not compared.
    """
    period = period_of(pair)
    compared = period if period <= _WHOLE else _WINDOW
    if period > _WHOLE:
        start = worst_cycle(pair) - _FORGOTTEN - _WINDOW // 2
        teeth = (pair.pinion.teeth, pair.gear.teeth)
        first = pair.mesh.first_teeth or (1, 1)
        pair = pair.with_(
            {"mesh.first_teeth": [(n - 1 + start) % z + 1 for n, z in zip(first, teeth, strict=True)]}
        )
    samples = min(samples, default_samples(period))
    motion = lumped.steady_state(pair, samples_per_cycle=samples)
    number = np.arange((_FORGOTTEN + compared) * samples + 1)
    reference = motion.isel(time=number % motion.sizes["time"])
    exact = _at_mean_speed(pair, reference, samples)
    kept = slice(_FORGOTTEN * samples, None)
    exact = exact.isel(time=kept)
    return pair, reference.isel(time=kept).assign_coords(time=exact["time"]), exact


def _at_mean_speed(pair: GearPair, reference: xr.Dataset, samples: int) -> xr.Dataset:
    """Multibody run that starts as the lumped motion, with its own brake torque.

    Under the lumped one it would turn faster or slower, and the phase of contact with it: a first run tells
    by how much the common rotation leaves the swing that the lumped contact follows, and how it accelerates.
    What friction adds over many turns of a free train is no phase of the lumped contact.
    """
    names = (*COORDINATES, *(f"{name}_dot" for name in COORDINATES))
    state = np.array([float(reference[name][0]) for name in names])
    g, bodies = pair.geometry, bodies_of(pair)
    radii = np.array([g.base_radius_pinion, g.base_radius_gear])
    inertia = np.array([bodies.inertia_pinion, bodies.inertia_gear])
    cycles, mass = (reference.sizes["time"] - 1) // samples, float((inertia / radii**2).sum())

    def common(motion: xr.Dataset) -> FloatArray:
        turned = np.stack([motion[name].to_numpy() for name in ("theta_p", "theta_g")])
        return np.asarray(inertia / radii @ turned / mass, dtype=np.float64)

    time = reference["time"].to_numpy()[1] * np.arange(reference.sizes["time"])
    own = swinging(tables(Laws(pair), 1.0, 1), LTVSystem.of(pair.healthy, "full"))
    size, start, teeth, way = own.eccentric[:, [0, 1, 2, 5]].T[..., None]
    swing = (size * way * np.sin(2.0 * np.pi * time / (own.duration * teeth) + start)).sum(axis=0)
    off = common(reference)[: samples + 1] - swing[: samples + 1]
    state[:2] -= off[0] / radii
    state[6:8] -= (off[-1] - off[0]) / own.duration / radii
    setup = prepare(pair, initial=state)
    first = record(setup, cycles, samples)[0]
    away = common(first) - swing
    half = (_FORGOTTEN // 2) * samples
    bend, rate, place = (float(c) for c in np.polyfit(time[half:], away[half:], 2))
    state[:2] -= place / radii
    state[6:8] -= rate / radii
    brake = setup.machine.torque_gear + 2.0 * bend * mass * g.base_radius_gear
    again = prepare(pair, initial=state).with_torques(setup.machine.torque_pinion, brake)
    run = record(again, cycles, samples)[0]
    return run.assign_attrs(brake_torque=brake)

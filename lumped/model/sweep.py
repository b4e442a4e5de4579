"""Periodic motion of a gear pair over pinion speed.

Sources: docs/theory/equations.md, "Periodic motion and the brake torque".
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from lumped.arguments import real_numbers
from lumped.errors import NumericalError
from lumped.labelling import labelled_dataset
from lumped.model.mesh_cycle import MeshCycle
from lumped.model.mesh_elements import MeshElements, mesh_elements
from lumped.model.periodic_system import LTVSystem, Supports, periodic_system
from lumped.model.powers import balance
from lumped.model.results import farthest_reversal, load_range, provenance
from lumped.model.steady import periodic_solution, sample_times
from lumped.path_of_contact import friction_path_function
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray, Progress

if TYPE_CHECKING:
    import xarray as xr


def speed_sweep(
    pair: AnyPair,
    speeds_rpm: Iterable[float],
    *,
    samples_per_cycle: int = 128,
    supports: Supports = "springs",
    progress: Progress | None = None,
) -> xr.Dataset:
    """Periodic motion over pinion speed.

    Parameters
    ----------
    pair : a validated gear pair; its speed is replaced
    speeds_rpm : pinion speeds [rpm], positive
    samples_per_cycle : times per cycle; peak to peak takes in extremes between them
    supports : of the gears, as of `lumped.steady_state`
    progress : called with the finished fraction

    Returns
    -------
    xarray.Dataset over ``speed`` [rpm]: peak-to-peak and root mean square (about the mean) of the
    transmission error and the translations, largest and smallest normal load (``results.load_range``),
    ``sliding_reversal``, largest distance from the pitch point at which a loaded pair slides against its
    nominal direction, mesh efficiency, and ``spectral_radius``, above 1 where the motion is unstable. A speed
    without periodic motion is NaN with ``periodic`` False.

    Raises
    ------
    ParameterError : a speed or the number of samples is out of range, before any work starts
    """
    pair = load_gear_pair(pair)
    speeds = running_speeds(speeds_rpm)
    pairs = [pair.with_({"operating.pinion_speed": float(rpm)}) for rpm in speeds]
    names = ("dte", "x_p", "x_g", "y_p", "y_g")
    table = {f"{n}_{kind}": np.full(speeds.size, np.nan) for n in names for kind in ("peak_to_peak", "rms")}
    table |= {
        n: np.full(speeds.size, np.nan)
        for n in (
            "normal_load_max",
            "normal_load_min",
            "sliding_reversal",
            "mesh_efficiency",
            "spectral_radius",
        )
    }
    periodic = np.zeros(speeds.size, dtype=bool)
    for j, system in enumerate(systems_over_speed(pairs, supports)):
        times = sample_times(system.period, samples_per_cycle)
        try:
            solution = periodic_solution(system, times, estimate_error=False)
        except NumericalError:
            continue
        finally:
            if progress is not None:
                progress((j + 1) / speeds.size)
        periodic[j] = True
        run = solution.values
        for name in names:
            table[f"{name}_peak_to_peak"][j] = solution.peak_to_peak[name]
            table[f"{name}_rms"][j] = np.std(run[name])
        found = load_range(pair.mesh.contact, run["normal_load"], run["contact"])
        table["normal_load_max"][j], table["normal_load_min"][j] = found
        table["sliding_reversal"][j] = _reversal(run, pair.geometry.L_XP)
        table["mesh_efficiency"][j] = balance(solution)["mesh_efficiency"]
        table["spectral_radius"][j] = solution.spectral_radius
    variables = {name: ("speed", values, *_label(name)) for name, values in table.items()}
    return labelled_dataset(
        variables | {"periodic": ("speed", periodic, "1", "whether a periodic motion exists")},
        {"speed": (speeds, "rpm", "pinion speed")},
        provenance(pair) | {"model": "lumped", "supports": supports},
    )


def _label(name: str) -> tuple[str, str]:
    """Unit and plain name of a variable of the sweep."""
    ratio = name in ("mesh_efficiency", "spectral_radius")
    unit = "1" if ratio else "N" if name.startswith("normal") else "m"
    return unit, name.replace("_", " ").replace("dte", "transmission error")


def systems_over_speed(pairs: Iterable[GearPair], supports: Supports = "springs") -> Iterator[LTVSystem]:
    """Systems of pairs that differ in speed alone: of the element laws only friction changes with it."""
    elements: MeshElements | None = None
    for at in pairs:
        g = at.geometry
        if elements is None:
            elements = mesh_elements(at)
        else:
            elements = replace(
                elements, friction=friction_path_function(at, interval=elements.stiffness.interval)
            )
        yield periodic_system(at, "full", cycle=MeshCycle(g, elements), supports=supports)


def _reversal(run: Mapping[str, FloatArray], pitch_point: float) -> float:
    """Largest distance from the pitch point at which a loaded pair slides backwards [m], or 0."""
    loaded = (run["contact"] > 0) & (run["normal_load"] > 0)
    return farthest_reversal(run["position"] - pitch_point, run["sliding_velocity"], loaded)


def running_speeds(speeds_rpm: Iterable[float]) -> FloatArray:
    """Return speeds [rpm] as an array, each checked to be positive and finite.

    Raises
    ------
    ParameterError : something else than positive finite numbers
    """
    return real_numbers("speeds_rpm", speeds_rpm, 0.0, above=True, unit="rpm", action="Give running speeds.")

"""
Can one pair run both quietly and chaotically?
==============================================

At 5250 rpm the lightly damped 50/50 pair has a quiet periodic motion that keeps contact. Started six static
deflections away, it loses contact and strikes, and no cycle repeats. Sampled once in each mesh cycle the
motion is a cloud with folds, and the distance of neighbours in it grows by a factor e in seven or eight
cycles.
"""

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

import floquet
import lumped
from floquet.gear.unilateral import unilateral_system
from validation.plots.style import BLACK, RED, legend, new_figure

CYCLES = 6000
SHOWN = 12
SAMPLES = 100


def compute() -> xr.Dataset:
    """Transmission error, its rate and the load on the teeth in both motions."""
    change = {"friction.law": "none", "mesh.damping_ratio": 0.02, "operating.pinion_speed": 5250.0}
    pair = lumped.load_gear_pair("kahraman_blankenship_50_50").with_({"mesh.contact": "prescribed"} | change)
    start = np.zeros(12)
    period = pair.geometry.mesh_period
    start[0] = 26e-6 / pair.geometry.base_radius_pinion
    settled = floquet.long_run(pair, start, settle_cycles=200, cycles=2000)
    periodic = floquet.periodic_orbit(pair).orbit
    system = unilateral_system(pair)
    result = xr.Dataset()
    phases = np.arange(SAMPLES) / SAMPLES
    for name, state in (("chaotic", settled.run.end), ("periodic", periodic.start)):
        run = system.run(state, period, CYCLES, settled.parameter, samples=phases)
        result[f"{name}_dte"] = "cycle", run.states[:, :3] @ system.output
        result[f"{name}_rate"] = "cycle", run.states[:, 3:] @ system.output / period
        result[f"{name}_load"] = "cycle", run.loads.sum(axis=1)
    result.attrs = {name: getattr(settled, name) for name in ("kind", "exponent", "uncertainty")}
    return result.assign_coords(cycle=run.phases)


def draw(result: xr.Dataset) -> Figure:
    """Draw the start of every cycle (left) and some cycles (right), grey where no tooth is loaded."""
    figure, ((phase_plane, time_axes),) = new_figure(1, 2, height=3.4, width_ratios=(2, 3))
    starts = result.isel(cycle=slice(None, None, SAMPLES))
    some = result.sel(cycle=slice(0, SHOWN))
    for name, look, size in (("chaotic", BLACK, 1.8), ("periodic", RED, 7.0)):
        point = {"color": look, "marker": ".", "markersize": size, "markeredgewidth": 0.0, "linestyle": ""}
        phase_plane.plot(starts[f"{name}_dte"] * 1e6, starts[f"{name}_rate"] * 1e3, **point)
        time_axes.plot(some["cycle"], some[f"{name}_dte"] * 1e6, color=look, label=name)
    is_separated = some["chaotic_load"] == 0.0
    place = time_axes.get_xaxis_transform()
    time_axes.fill_between(
        some["cycle"], 0, 1, where=is_separated, transform=place, color="0.88", linewidth=0
    )
    phase_plane.set(xlabel="transmission error [µm]", ylabel="its rate [mm/s]")
    time_axes.set(xlabel="mesh cycles", ylabel="transmission error [µm]", xlim=(0, SHOWN))
    exponent = "Lyapunov exponent {exponent:.3f} ± {uncertainty:.3f} per cycle".format(**result.attrs)
    time_axes.set_title(exponent, fontsize=9)
    legend(time_axes)
    return figure


if __name__ == "__main__":
    draw(compute()).savefig("chaos.png", dpi=150)

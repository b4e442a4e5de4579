"""spurcheck simulate: the motion of a pair in time."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

from validation.commands import options as opt
from validation.commands.terminal import guarded, note, print_json, progress_bar, show
from validation.files.formatting import number, quantity

if TYPE_CHECKING:
    import xarray as xr

#: Mesh orders of a run-up that are printed.
_MESH_ORDERS = 5


@guarded
def simulate(
    pair: opt.Pair,
    files: opt.ResultFiles,
    model: Literal["lumped", "multibody"] = "lumped",
    fidelity: Literal["exact", "linear"] = "exact",
    cycles: int = 20,
    samples: int = 256,
    initial: Literal["static", "periodic"] = "static",
    steady: bool = False,
    run_up: str | None = None,
    seconds: float = 2.0,
    supports: opt.Supports = "springs",
    as_json: opt.Json = False,
) -> None:
    """Simulate a gear pair: transmission error, tooth loads, friction and motions in time.

    Prints the main numbers of the last mesh cycle; -o writes all histories (SI units: m, N, s, rad).

    [bold]Examples[/bold]
    spurcheck simulate nasa_28_28 --speed 4000 --torque 79.1 -o run.nc
    spurcheck simulate my_pair.toml --model multibody --cycles 50 -o run.csv
    spurcheck simulate --steady --law coulomb -o steady.png
    spurcheck simulate my_pair.toml --run-up 500..6000 --seconds 5 -o waterfall.png
    spurcheck simulate my_pair.toml --supports shafts -o on_shafts.nc

    Parameters
    ----------
    model : Which model to run.
    fidelity : Of the multibody model.
    cycles : Mesh cycles to run.
    samples : Output times per mesh cycle.
    initial : Start at rest under the mean load, or on the periodic motion.
    steady : Only the periodic motion over one mesh cycle (lumped).
    run_up FROM..TO : Speed that rises or falls evenly, rpm (lumped).
    seconds : Duration of --run-up.
    """
    import lumped
    from lumped.errors import refuse
    from lumped.model.results import cycle_peak_to_peak, load_range
    from lumped.quasi_static.contacts import contact_of
    from validation.validity.flags import contact_loss

    rising, exact = run_up is not None, model == "multibody"
    for option, wrong, allowed in (
        ("--steady", steady and exact, "without --model multibody"),
        ("--run-up", rising and (steady or exact), "without --steady and --model multibody"),
        ("--seconds", seconds != 2.0 and not rising, "with --run-up"),
        ("--fidelity", fidelity != "exact" and not exact, "with --model multibody"),
        ("--cycles", cycles != 20 and (steady or rising), "without --steady and --run-up"),
        ("--initial", initial != "static" and (steady or rising), "without --steady and --run-up"),
    ):
        if wrong:
            raise refuse(option, "given", allowed, "Here it has no effect: leave it out.")
    if run_up is not None:
        with progress_bar("run-up") as tell:
            begin, _, end = run_up.partition("..")
            if not end:
                raise refuse("--run-up", run_up, "two speeds FROM..TO", "For example 500..6000.")
            ends = (opt.number_in("--run-up", begin, "rpm"), opt.number_in("--run-up", end, "rpm"))
            result = lumped.run_up(pair, ends, seconds, supports=supports, progress=tell)
        _show_run_up(pair.name, result, as_json=as_json)
        return files.write(result)
    with progress_bar(f"{model} model") as tell:
        common: dict[str, Any] = {"samples_per_cycle": samples, "supports": supports}
        if steady:
            result = lumped.steady_state(pair, **common)
        elif model == "lumped":
            result = lumped.simulate(pair, cycles, initial=initial, progress=tell, **common)
        else:
            import multibody

            common |= {"fidelity": fidelity, "initial": initial}
            result = multibody.simulate(pair, cycles, progress=tell, **common)
    g, form = pair.geometry, contact_of(pair)
    # A transient ends on the end of its last cycle, a periodic motion leaves its own out.
    last = result.isel(time=slice(-samples - (not steady), None))
    largest, smallest = load_range(pair, last["normal_load"].to_numpy(), last["contact"].to_numpy())
    dte = cycle_peak_to_peak(last, "dte", g.mesh_period if steady else None)
    factor = largest / (pair.operating.pinion_torque / g.base_radius_pinion)
    efficiency = f"mesh efficiency{'' if form.conservative else ', sliding alone'}"
    numbers = {
        "dte_peak_to_peak": ("transmission error, peak to peak", dte, "m", 3),
        "dte_mean": ("transmission error, mean", float(last["dte"][:samples].mean()), "m", 4),
        "normal_load_max": ("largest load of a tooth pair", largest, "N", 3),
        "normal_load_min": (f"smallest load of {form.pressed}", smallest, "N", 3),
        "load_factor": ("largest load over static load", factor, "1", 3),
        "mesh_efficiency": (efficiency, float(result.attrs["mesh_efficiency"]), "%", 4),
        "brake_torque": ("brake torque that holds the speed", float(result.attrs["brake_torque"]), "N m", 6),
    }
    # Where energy is not conserved the brake torque balances sliding alone.
    if not form.conservative and "power_energy_residual" in result.attrs:
        residual = float(result.attrs["power_energy_residual"])
        words = "losses that the torques do not balance"
        numbers["power_energy_residual"] = (words, residual, "W", 4)
    if as_json:
        values = {key: value for key, (_, value, *_) in numbers.items()}
        print_json({"gear_pair": pair.name, "model": model, "supports": supports} | values)
    else:
        rows = (
            (words, quantity(100.0 * value if unit == "%" else value, unit, digits, measured=True))
            for words, value, unit, digits in numbers.values()
        )
        show(f"{pair.name} on {supports}, last mesh cycle", "quantity | >value", rows)
    separation = contact_loss(pair, g, last)
    if separation.state != "ok" and (model == "lumped" or fidelity == "linear"):
        note(
            f"contact loss: {separation.detail}. Here the teeth pull instead, so the motion is not to be "
            "relied on. Use --model multibody, or more torque or damping."
        )
    if (radius := float(result.attrs.get("spectral_radius", 0.0))) > 1.0:
        note(
            f"this periodic motion is unstable: a disturbance grows {number(radius)} times in a mesh cycle. "
            "See 'spurcheck stability', or raise the damping."
        )
    files.write(result)


def _show_run_up(name: str, result: xr.Dataset, *, as_json: bool) -> None:
    """Print where each mesh order is largest."""
    from validation.signals import waterfall

    amplitude = waterfall(result)["amplitude"]
    orders = range(1, _MESH_ORDERS + 1)
    heights = [amplitude.sel(order=order, method="nearest") for order in orders]
    at = [max(zip(one.values.tolist(), one["speed_rpm"].values.tolist(), strict=True)) for one in heights]
    if as_json:
        print_json({"gear_pair": name, "variable": "dte", "largest": dict(zip(orders, at, strict=True))})
    else:
        rows = ((n, (a, "m"), rpm) for n, (a, rpm) in zip(orders, at, strict=True))
        title = f"{name}, run-up: transmission error"
        show(title, ">mesh order | >largest amplitude | >at speed [rpm]", rows)

"""spurcheck simulate, uncertainty, teeth, interactive: motions of a pair, and what changes them."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from validation.commands import options as opt
from validation.commands.terminal import guarded, note, print_json, progress_bar, show, stderr, stdout
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
    contact: Literal["linear", "unilateral"] = "linear",
    supports: opt.Supports = None,
    as_json: opt.Json = False,
) -> None:
    """Simulate a gear pair: transmission error, tooth loads, friction and motions in time.

    Prints the main numbers of the last mesh cycle; -o writes all histories (SI units: m, N, s, rad).

    [bold]Examples[/bold]
    spurcheck simulate nasa_28_28 --speed 4000 --torque 79.1 -o run.nc
    spurcheck simulate my_pair.toml --model multibody --cycles 50 -o run.csv
    spurcheck simulate --steady --law coulomb -o steady.png
    spurcheck simulate my_pair.toml --run-up 500..6000 --seconds 5 -o waterfall.png
    spurcheck simulate my_pair.toml --supports springs -o on_springs.nc

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
    contact : Linear, in which teeth may pull, or unilateral, in which they only push (lumped).
    """
    import numpy as np

    import lumped
    from lumped.errors import refuse
    from lumped.model.periodic_system import supports_of
    from lumped.model.results import cycle_peak_to_peak, load_range
    from lumped.quasi_static.contacts import contact_of
    from validation.validity.flags import contact_loss

    held = supports_of(pair, supports)
    rising = run_up is not None
    exact = model == "multibody"
    for option, wrong, allowed in (
        ("--steady", steady and exact, "without --model multibody"),
        ("--run-up", rising and (steady or exact), "without --steady and --model multibody"),
        ("--seconds", seconds != 2.0 and not rising, "with --run-up"),
        ("--contact", contact != "linear" and exact, "without --model multibody"),
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
            result = lumped.run_up(pair, ends, seconds, contact=contact, supports=held, progress=tell)
        _show_run_up(pair.name, held, result, as_json=as_json)
        return files.write(result)
    with progress_bar(f"{model} model") as tell:
        common: dict[str, Any] = {"samples_per_cycle": samples, "supports": held}
        if steady:
            result = lumped.steady_state(pair, contact=contact, **common)
        elif model == "lumped":
            result = lumped.simulate(pair, cycles, contact=contact, initial=initial, progress=tell, **common)
        else:
            import multibody

            common |= {"fidelity": fidelity, "initial": initial}
            result = multibody.simulate(pair, cycles, progress=tell, **common)
    g = pair.geometry
    form = contact_of(pair)
    # A transient ends on the end of its last cycle, a periodic motion leaves its own out.
    last = result.isel(time=slice(-samples - (not steady), None))
    largest, smallest = load_range(pair, last["normal_load"].to_numpy(), last["contact"].to_numpy())
    dte = cycle_peak_to_peak(last, "dte", g.mesh_period if steady else None)
    factor = largest / (pair.operating.pinion_torque / g.base_radius_pinion)
    numbers = {
        "dte_peak_to_peak": ("transmission error, peak to peak", dte, "m", 3),
        "dte_mean": ("transmission error, mean", float(last["dte"][:samples].mean()), "m", 4),
        "normal_load_max": ("largest load of a tooth pair", largest, "N", 3),
        "normal_load_min": (f"smallest load of {form.pressed}", smallest, "N", 3),
        "load_factor": ("largest load over static load", factor, "1", 3),
        "mesh_efficiency": ("mesh efficiency", float(result.attrs.get("mesh_efficiency", np.nan)), "%", 4),
        "brake_torque": ("brake torque that holds the speed", float(result.attrs["brake_torque"]), "N m", 6),
    }
    # Where energy is not conserved the brake torque balances sliding alone.
    if not form.conservative and "power_energy_residual" in result.attrs:
        residual = float(result.attrs["power_energy_residual"])
        words = "losses that the torques do not balance"
        numbers["power_energy_residual"] = (words, residual, "W", 4)
    if as_json:
        values = {key: value for key, (_, value, *_) in numbers.items()}
        print_json({"gear_pair": pair.name, "model": model, "supports": held} | values)
    else:
        rows = (
            (words, quantity(100.0 * value if unit == "%" else value, unit, digits, measured=True))
            for words, value, unit, digits in numbers.values()
        )
        show(f"{pair.name} on {held}, last mesh cycle", "quantity | >value", rows)
    separation = contact_loss(pair, g, last)
    linear = contact == "linear" if model == "lumped" else fidelity == "linear"
    if separation.state != "ok" and linear:
        note(
            f"contact loss: {separation.detail}. Here the teeth pull instead, so the motion is not to be "
            "relied on. Use --contact unilateral, or more torque or damping."
        )
    if (radius := float(result.attrs.get("spectral_radius", 0.0))) > 1.0:
        note(
            f"this periodic motion is unstable: a disturbance grows {number(radius)} times in a mesh cycle. "
            "See 'spurcheck stability', or raise the damping."
        )
    files.write(result)


def _show_run_up(name: str, supports: opt.SupportsName, result: xr.Dataset, *, as_json: bool) -> None:
    """Print where each mesh order is largest."""
    from validation.signals import waterfall

    orders = range(1, _MESH_ORDERS + 1)
    amplitude = waterfall(result)["amplitude"].sel(order=list(orders), method="nearest")
    sizes = amplitude.max("speed_rpm").to_numpy()
    speeds = amplitude.idxmax("speed_rpm").to_numpy()
    if as_json:
        largest = dict(zip(orders, zip(sizes.tolist(), speeds.tolist(), strict=True), strict=True))
        print_json({"gear_pair": name, "supports": supports, "variable": "dte", "largest": largest})
    else:
        rows = ((f"{n}", (size, "m"), rpm) for n, size, rpm in zip(orders, sizes, speeds, strict=True))
        columns = ">mesh order | >largest amplitude | >at speed [rpm]"
        show(f"{name} on {supports}, run-up: transmission error", columns, rows)


@guarded
def uncertainty(
    pair: opt.Pair,
    files: opt.DataFiles,
    samples: opt.Samples = None,
    seed: int = 1,
    seconds: opt.Seconds = None,
    supports: opt.Supports = None,
) -> None:
    r"""Predict a gear pair many times while its uncertain inputs vary.

    Inputs vary as the section \[uncertainty] of the file states, and by documented defaults where a value is
    assumed. Teeth of a tolerance class are drawn anew in every sample.

    [bold]Examples[/bold]
    spurcheck uncertainty my_pair.toml
    spurcheck uncertainty my_pair.toml --samples 512 -o samples.nc

    Parameters
    ----------
    seed : Of the sampled points.
    """
    import numpy as np

    from validation.prediction.motion import QUANTITIES
    from validation.prediction.uncertainty import TEETH, transmission_error
    from validation.prediction.uncertainty import uncertainty as run

    limits = opt.limits_of_samples(samples, seconds)
    with progress_bar("uncertain inputs") as tell:
        found = run(pair, seed=seed, supports=supports, progress=tell, **limits)
    rows = (
        (words, *((float(v), unit) for v in (found.attrs[f"given_{name}"], *found[f"{name}_percentile"])))
        for name, (unit, words) in (QUANTITIES | TEETH).items()
        if f"given_{name}" in found.attrs
    )
    show(
        f"{pair.name} on {found.attrs['supports']}: results",
        "result | >as given | >5 % | >50 % | >95 %",
        rows,
    )
    name = transmission_error(found)
    swing, correlation = (found[f"{name}_{one}"].to_numpy() for one in ("swing", "rank_correlation"))
    moves = [
        (str(found["input"].to_numpy()[j]), str(found.attrs["written"][j]), (swing[j].min(), "m"),
         (swing[j].max(), "m"), round(float(correlation[j]), 2))
        for j in np.argsort(-np.nan_to_num(np.ptp(swing, axis=1)), kind="stable")
    ]  # fmt: skip
    title = f"what moves the {(QUANTITIES | TEETH)[name][1]}"
    show(title, "input | range | >from | >to | >rank corr.", moves)
    counts = {
        "refused": "refused", "contact_lost": "contact lost", "unstable": "unstable",
        "linear": "with the linear motion, as no other was found",
    }  # fmt: skip
    shares = ", ".join(f"{found.attrs[name]} {words}" for name, words in counts.items())
    taken = found.attrs["taken"]
    asked = found.attrs["asked"]
    stdout().print(f"{taken} of {asked} samples, seed {seed}: {shares}")
    if taken < asked:
        note(f"{opt.time_words(found)}.")
    files.write(found)


@guarded
def teeth(pair: opt.Pair, files: opt.DataFiles, supports: opt.Supports = None) -> None:
    r"""Show what teeth that differ do: loads, sidebands, indicators, beside the twin with like teeth.

    Teeth differ by sections of the parameter file:

    \[pinion.deviations] tolerance_class = 6, seed = 1 (random errors of an ISO 1328-1 class), or
    index = \[...] in um, or file = "pinion.csv"

    \[pinion.mounting] eccentricity = 12 (um), phase = 30 (deg)

    \[\[pinion.faults]] kind = "crack", tooth = 4, depth = 1.0 (mm); also "spall" and "chip"

    [bold]Examples[/bold]
    spurcheck teeth my_pair.toml
    spurcheck teeth my_pair.toml --set pinion.deviations.tolerance_class=6 -o motion.nc
    """
    from validation.signals.findings import GEARS, NOISE, TeethFindings, deviations_table, rpm_and_period

    with progress_bar("motion over the period of the teeth"):
        found = TeethFindings(pair, supports)
    console = stdout()
    console.print(f"{pair.name} on {found.supports}: at {rpm_and_period(found)}")
    console.print(f"contact: {found.motion.attrs['touch']}")
    given = deviations_table(pair).to_dataframe()
    columns = "gear | >index deviations | >largest step | >eccentricity | >ISO 1328-1 class"
    sizes = ["cumulative", "pitch", "eccentricity"]
    classes = ("none" if one == 12 else f"{one:g}" for one in given["tolerance_class"])
    lengths = ([(length, "m") for length in row] for row in given[sizes].to_numpy())
    show("", columns, ((gear, *row, one) for gear, row, one in zip(GEARS, lengths, classes, strict=True)))
    both = found.motion, found.twin
    swings = [(float(one.attrs["dte_peak_to_peak"]), "m") for one in both]
    loads = [(found.load(one) / found.static_force, "1") for one in both]
    rows: list[tuple[Any, ...]] = [
        ("transmission error, peak to peak", *swings),
        ("largest load on one tooth / mean mesh force", *loads),
        ("growth of a perturbation in a mesh cycle", *found.rates),
    ]
    for gear in GEARS:
        data = found.indicators(gear)["value"].sel(record=["pair", "healthy twin"])
        for name in ("RMS_residual", "FM4"):
            unit = "m/s^2" if name.startswith("RMS") else "1"
            rows.append((f"{name}, {gear}", *((float(one), unit) for one in data.sel(indicator=name))))
    show("", "result | >teeth as given | >like teeth", rows)
    console.print(f"indicators: acceleration of the pinion, with noise of {100 * NOISE:.0f} % of its rms")
    console.print(found.sentence)
    files.write(found.motion)


@guarded
def interactive(
    pair: opt.AlikePair,
    output: Annotated[Path, opt.output("Page to write, .html; its numbers go beside it as .nc.")] = Path(
        "interactive.html"
    ),
    supports: opt.Supports = None,
    force: opt.Force = False,
) -> None:
    """Write a page to explore stability over speed and damping, and the response over speed.

    One HTML file that opens in any browser, without network: point at a chart for values, zoom, move the
    sliders, or use the keyboard alone. Every number of it is also written as NetCDF. It is of a pair on the
    springs of 'bearings'; one with shafts needs --supports springs.

    [bold]Examples[/bold]
    spurcheck interactive -o page.html
    spurcheck interactive my_pair.toml --set mesh.damping_ratio=0.02 -o low_damping.html
    """
    from lumped.model.periodic_system import on_springs
    from validation.files.output import check_file
    from validation.interactive import write_interactive_page

    pair = on_springs(pair, supports, "the interactive page")
    check_file(output, (".html",), force=force)
    data = check_file(output.with_suffix(".nc"), (".nc",), force=force)
    with progress_bar("interactive page") as tell:
        write_interactive_page(pair, output, data=data, new=not force, progress=tell)
    stderr().print(f"wrote {output} and {data}")

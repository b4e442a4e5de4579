"""spurcheck simulate, uncertainty, teeth, interactive: motions of a gear pair, influences on the motion."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from validation.commands import options as opt
from validation.commands.cluster import cluster_of
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
    fidelity : Multibody model: exact (its own contact, finite rotations) or linear (the lumped equations).
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

    supports_used = supports_of(pair, supports)
    is_run_up = run_up is not None
    is_multibody = model == "multibody"
    for option, has_no_effect, allowed in (
        ("--steady", steady and is_multibody, "without --model multibody"),
        ("--run-up", is_run_up and (steady or is_multibody), "without --steady and --model multibody"),
        ("--seconds", seconds != 2.0 and not is_run_up, "with --run-up"),
        ("--contact", contact != "linear" and is_multibody, "without --model multibody"),
        ("--fidelity", fidelity != "exact" and not is_multibody, "with --model multibody"),
        ("--cycles", cycles != 20 and (steady or is_run_up), "without --steady and --run-up"),
        ("--initial", initial != "static" and (steady or is_run_up), "without --steady and --run-up"),
    ):
        if has_no_effect:
            raise refuse(option, "given", allowed, "Here it has no effect: leave it out.")
    if run_up is not None:
        with progress_bar("run-up") as tell:
            begin, _, end = run_up.partition("..")
            if not end:
                raise refuse("--run-up", run_up, "two speeds FROM..TO", "For example 500..6000.")
            ends = (opt.number_in("--run-up", begin, "rpm"), opt.number_in("--run-up", end, "rpm"))
            result = lumped.run_up(
                pair, ends, seconds, contact=contact, supports=supports_used, progress=tell
            )
        _show_run_up(pair.name, supports_used, result, as_json=as_json)
        return files.write(result)
    with progress_bar(f"{model} model") as tell:
        common: dict[str, Any] = {"samples_per_cycle": samples, "supports": supports_used}
        if steady:
            result = lumped.steady_state(pair, contact=contact, **common)
        elif model == "lumped":
            result = lumped.simulate(pair, cycles, contact=contact, initial=initial, progress=tell, **common)
        else:
            import multibody

            common |= {"fidelity": fidelity, "initial": initial}
            result = multibody.simulate(pair, cycles, progress=tell, **common)
    g = pair.geometry
    contact_form = contact_of(pair)
    # A transient ends on the end of its last cycle, a periodic motion leaves its own out.
    last = result.isel(time=slice(-samples - (not steady), None))
    largest, smallest = load_range(pair, last["normal_load"].to_numpy(), last["contact"].to_numpy())
    dte = cycle_peak_to_peak(last, "dte", g.mesh_period if steady else None)
    factor = largest / (pair.operating.pinion_torque / g.base_radius_pinion)
    numbers = {
        "dte_peak_to_peak": ("transmission error, peak to peak", dte, "m", 3),
        "dte_mean": ("transmission error, mean", float(last["dte"][:samples].mean()), "m", 4),
        "normal_load_max": ("largest load of a tooth pair", largest, "N", 3),
        "normal_load_min": (f"smallest load of {contact_form.pressed}", smallest, "N", 3),
        "load_factor": ("largest load over static load", factor, "1", 3),
        "mesh_efficiency": ("mesh efficiency", float(result.attrs.get("mesh_efficiency", np.nan)), "%", 4),
        "brake_torque": ("brake torque that holds the speed", float(result.attrs["brake_torque"]), "N m", 6),
    }
    # Where energy is not conserved the brake torque balances sliding alone.
    if not contact_form.conservative and "power_energy_residual" in result.attrs:
        residual = float(result.attrs["power_energy_residual"])
        words = "losses that the torques do not balance"
        numbers["power_energy_residual"] = (words, residual, "W", 4)
    if as_json:
        values = {key: value for key, (_, value, *_) in numbers.items()}
        print_json({"gear_pair": pair.name, "model": model, "supports": supports_used} | values)
    else:
        rows = (
            (words, quantity(100.0 * value if unit == "%" else value, unit, digits, measured=True))
            for words, value, unit, digits in numbers.values()
        )
        show(f"{pair.name} on {supports_used}, last mesh cycle", "quantity | >value", rows)
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
    """Print the largest amplitude of each mesh order and the speed at which the order is largest."""
    from validation.signals import waterfall

    orders = range(1, _MESH_ORDERS + 1)
    amplitude = waterfall(result)["amplitude"].sel(order=list(orders), method="nearest")
    largest_amplitudes = amplitude.max("speed_rpm").to_numpy()
    speeds_of_largest = amplitude.idxmax("speed_rpm").to_numpy()
    if as_json:
        largest = dict(
            zip(
                orders, zip(largest_amplitudes.tolist(), speeds_of_largest.tolist(), strict=True), strict=True
            )
        )
        print_json({"gear_pair": name, "supports": supports, "variable": "dte", "largest": largest})
    else:
        rows = (
            (f"{n}", (size, "m"), rpm)
            for n, size, rpm in zip(orders, largest_amplitudes, speeds_of_largest, strict=True)
        )
        columns = ">mesh order | >largest amplitude | >at speed [rpm]"
        show(f"{name} on {supports}, run-up: transmission error", columns, rows)


@guarded
def uncertainty(
    pair: opt.Pair,
    files: opt.DataFiles,
    samples: opt.Samples = None,
    seed: int = 1,
    seconds: opt.Seconds = None,
    cluster: opt.Cluster = None,
    wait_seconds: opt.WaitSeconds = None,
    supports: opt.Supports = None,
) -> None:
    r"""Predict a gear pair many times while its uncertain inputs vary.

    Inputs vary as the section \[uncertainty] of the file states, and by documented defaults where a value is
    assumed. Teeth of a tolerance class are drawn anew in every sample. Without tooth errors in the file the
    teeth are perfect here: only the report draws teeth of an assumed class.

    [bold]Examples[/bold]
    spurcheck uncertainty my_pair.toml
    spurcheck uncertainty my_pair.toml --samples 512 -o samples.nc
    spurcheck uncertainty my_pair.toml --samples 4096 --cluster local:8 -o samples.nc

    Parameters
    ----------
    seed : Start of the random numbers: the same seed gives the same possible machines.
    """
    import numpy as np

    from validation.prediction.motion import QUANTITIES
    from validation.prediction.uncertainty import TEETH, transmission_error
    from validation.prediction.uncertainty import uncertainty as run

    limits = opt.limits_of_samples(samples, seconds, cluster)
    with cluster_of(cluster, wait_seconds) as executor, progress_bar("uncertain inputs") as tell:
        predictions = run(pair, seed=seed, supports=supports, executor=executor, progress=tell, **limits)
    rows = (
        (
            words,
            *(
                (float(v), unit)
                for v in (predictions.attrs[f"given_{name}"], *predictions[f"{name}_percentile"])
            ),
        )
        for name, (unit, words) in (QUANTITIES | TEETH).items()
        if f"given_{name}" in predictions.attrs
    )
    show(
        f"{pair.name} on {predictions.attrs['supports']}: results",
        "result | >as given | >5 % | >50 % | >95 %",
        rows,
    )
    name = transmission_error(predictions)
    swing, correlation = (predictions[f"{name}_{one}"].to_numpy() for one in ("swing", "rank_correlation"))
    input_rows = [
        (str(predictions["input"].to_numpy()[j]), str(predictions.attrs["written"][j]), (swing[j].min(), "m"),
         (swing[j].max(), "m"), round(float(correlation[j]), 2))
        for j in np.argsort(-np.nan_to_num(np.ptp(swing, axis=1)), kind="stable")
    ]  # fmt: skip
    title = f"what moves the {(QUANTITIES | TEETH)[name][1]}"
    show(title, "input | range | >from | >to | >rank corr.", input_rows)
    counts = {
        "refused": "refused", "contact_lost": "contact lost", "unstable": "unstable",
        "linear": "with the linear motion, as no other was found",
    }  # fmt: skip
    shares = ", ".join(f"{predictions.attrs[name]} {words}" for name, words in counts.items())
    samples_taken = predictions.attrs["taken"]
    samples_wanted = predictions.attrs["asked"]
    stdout().print(f"{samples_taken} of {samples_wanted} samples, seed {seed}: {shares}")
    if samples_taken < samples_wanted:
        note(f"{opt.time_words(predictions)}.")
    files.write(predictions)


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
        findings = TeethFindings(pair, supports)
    console = stdout()
    console.print(f"{pair.name} on {findings.supports}: at {rpm_and_period(findings)}")
    console.print(f"contact: {findings.motion.attrs['touch']}")
    deviations = deviations_table(pair).to_dataframe()
    columns = "gear | >index deviations | >largest step | >eccentricity | >ISO 1328-1 class"
    sizes = ["cumulative", "pitch", "eccentricity"]
    classes = ("none" if number == 12 else f"{number:g}" for number in deviations["tolerance_class"])
    lengths = ([(length, "m") for length in row] for row in deviations[sizes].to_numpy())
    show(
        "", columns, ((gear, *row, number) for gear, row, number in zip(GEARS, lengths, classes, strict=True))
    )
    motions = findings.motion, findings.twin
    swings = [(float(number.attrs["dte_peak_to_peak"]), "m") for number in motions]
    loads = [(findings.tooth_load(number), "1") for number in motions]
    rows: list[tuple[Any, ...]] = [
        ("transmission error, peak to peak", *swings),
        ("largest load on one tooth / mean mesh force", *loads),
        ("growth of a perturbation in a mesh cycle", *findings.rates),
    ]
    for gear in GEARS:
        data = findings.indicators(gear)["value"].sel(record=["pair", "healthy twin"])
        for name in ("RMS_residual", "FM4"):
            unit = "m/s^2" if name.startswith("RMS") else "1"
            rows.append((f"{name}, {gear}", *((float(number), unit) for number in data.sel(indicator=name))))
    show("", "result | >teeth as given | >like teeth", rows)
    console.print(f"indicators: acceleration of the pinion, with noise of {100 * NOISE:.0f} % of its rms")
    console.print(findings.sentence)
    files.write(findings.motion)


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
    sliders, or use the keyboard alone. Every number of the page is also written as NetCDF. The page is for a
    pair on the springs of 'bearings'; a pair with shafts needs --supports springs.

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

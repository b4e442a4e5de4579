"""spurcheck uncertainty, teeth, interactive: a pair with other inputs, tooth errors, speeds, damping."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

from validation.commands import options as opt
from validation.commands.terminal import guarded, progress_bar, show, stderr, stdout


@guarded
def uncertainty(pair: opt.Pair, files: opt.DataFiles, samples: int = 128, seed: int = 1) -> None:
    r"""Predict a gear pair many times while its uncertain inputs vary.

    Inputs vary as the section \[uncertainty] of the file states, and by documented defaults where the source
    of a value says that it is assumed. Teeth of a tolerance class are drawn anew in every sample.

    [bold]Examples[/bold]
    spurcheck uncertainty my_pair.toml
    spurcheck uncertainty my_pair.toml --samples 512 -o samples.nc

    Parameters
    ----------
    samples : Number of predictions.
    seed : Of the sampled points.
    """
    import numpy as np

    from validation.prediction.motion import QUANTITIES
    from validation.prediction.uncertainty import TEETH
    from validation.prediction.uncertainty import uncertainty as run

    with progress_bar("uncertain inputs") as tell:
        found = run(pair, samples, seed, progress=tell)
    rows = (
        (words, *((float(v), unit) for v in (found.attrs[f"given_{name}"], *found[f"{name}_percentile"])))
        for name, (unit, words) in (QUANTITIES | TEETH).items()
        if f"given_{name}" in found.attrs
    )
    show(f"{pair.name}: results", "result | >as given | >5 % | >50 % | >95 %", rows)
    swing = found["dte_peak_to_peak_swing"].to_numpy()
    correlation = found["dte_peak_to_peak_rank_correlation"].to_numpy()
    moves = [
        (str(found["input"].to_numpy()[j]), str(found.attrs["written"][j]), (swing[j].min(), "m"),
         (swing[j].max(), "m"), round(float(correlation[j]), 2))
        for j in np.argsort(-np.nan_to_num(np.ptp(swing, axis=1)), kind="stable")
    ]  # fmt: skip
    show("what moves the transmission error", "input | range | >from | >to | >rank corr.", moves)
    counts = ("refused", "contact_lost", "unstable")
    stdout().print(
        f"{samples} samples, seed {seed}: "
        + ", ".join(f"{found.attrs[name]} {name.replace('_', ' ')}" for name in counts)
    )
    files.write(found)


@guarded
def teeth(pair: opt.Pair, files: opt.DataFiles) -> None:
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
        found = TeethFindings(pair)
    console = stdout()
    console.print(f"{pair.name}, {rpm_and_period(found)}")
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
            rows.append((f"{name}, {gear}", *((float(one), "1") for one in data.sel(indicator=name))))
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
    force: opt.Force = False,
) -> None:
    """Write a page to explore stability over speed and damping, and the response over speed.

    One HTML file that opens in any browser, without network: point at a chart for values, zoom, move the
    sliders, or use the keyboard alone. Every number of it is also written as NetCDF.

    [bold]Examples[/bold]
    spurcheck interactive -o page.html
    spurcheck interactive my_pair.toml --set mesh.damping_ratio=0.02 -o low_damping.html
    """
    from validation.files.output import check_file
    from validation.interactive import write_interactive_page

    check_file(output, (".html",), force=force)
    data = check_file(output.with_suffix(".nc"), (".nc",), force=force)
    with progress_bar("interactive page") as tell:
        write_interactive_page(pair, output, data=data, new=not force, progress=tell)
    stderr().print(f"wrote {output} and {data}")

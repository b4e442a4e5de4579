"""spurcheck teeth: pitch errors, eccentricity and damaged teeth, and what a sensor finds of them."""

from __future__ import annotations

from validation.commands import options as opt
from validation.commands.terminal import guarded, progress_bar, stdout, table


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
    from validation.files.formatting import number, quantity
    from validation.signals.findings import GEARS, NOISE, TeethFindings, deviations_table, rpm_and_period

    with progress_bar("motion over the period of the teeth"):
        found = TeethFindings(pair)
    console = stdout()
    console.print(f"{pair.name}, {rpm_and_period(found)}")
    console.print(f"contact: {found.motion.attrs['touch']}")
    given = deviations_table(pair)
    shown = table("", "gear", ">index deviations", ">largest step", ">eccentricity", ">ISO 1328-1 class")
    for at, gear in enumerate(GEARS):
        sizes = (quantity(float(given[n][at]), "m", 3) for n in ("cumulative", "pitch", "eccentricity"))
        held = int(given["tolerance_class"][at])
        shown.add_row(gear, *sizes, str(held) if held < 12 else "none")
    console.print(shown)
    shown = table("", "result", ">teeth as given", ">like teeth")
    ends = [quantity(float(one.attrs["dte_peak_to_peak"]), "m", 3) for one in (found.motion, found.twin)]
    shown.add_row("transmission error, peak to peak", *ends)
    loads = [number(found.load(one) / found.static_force, 3) for one in (found.motion, found.twin)]
    shown.add_row("largest load on one tooth / mean mesh force", *loads)
    shown.add_row("growth of a perturbation in a mesh cycle", *(number(rate, 4) for rate in found.rates))
    for gear in GEARS:
        data = found.indicators(gear)["value"]
        for name in ("RMS_residual", "FM4"):
            values = [float(data.sel(indicator=name, record=r)) for r in ("pair", "healthy twin")]
            shown.add_row(f"{name}, {gear}", *(number(value, 3) for value in values))
    console.print(shown)
    console.print(f"indicators: acceleration of the pinion, with noise of {100 * NOISE:.0f} % of its rms")
    console.print(found.sentence)
    files.write(found.motion)

"""spurcheck uncertainty: how far the prediction moves with the uncertain inputs."""

from __future__ import annotations

from validation.commands import options as opt
from validation.commands.terminal import guarded, progress_bar, stdout, table


@guarded
def uncertainty(pair: opt.Pair, files: opt.DataFiles, samples: int = 128, seed: int = 1) -> None:
    r"""Predict a gear pair many times while its uncertain inputs vary.

    Inputs vary as the section \\[uncertainty] of the file states, and by documented defaults where the source
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

    from validation.files.formatting import number, quantity
    from validation.prediction.motion import QUANTITIES
    from validation.prediction.uncertainty import TEETH
    from validation.prediction.uncertainty import uncertainty as run

    with progress_bar("uncertain inputs") as tell:
        found = run(pair, samples, seed, progress=tell)
    console = stdout()
    shown = table(f"{pair.name}: results", "result", ">as given", ">5 %", ">50 %", ">95 %")
    for name, (unit, words) in (QUANTITIES | TEETH).items():
        if f"given_{name}" not in found.attrs:
            continue
        ends = found[f"{name}_percentile"].to_numpy()
        given = float(found.attrs[f"given_{name}"])
        shown.add_row(words, *(quantity(float(v), unit, 3) for v in (given, *ends)))
    console.print(shown)
    shown = table("what moves the transmission error", "input", "range", ">from", ">to", ">rank corr.")
    swing = found["dte_peak_to_peak_swing"].to_numpy()
    for j in np.argsort(-np.nan_to_num(np.ptp(swing, axis=1)), kind="stable"):
        moved = (quantity(float(end), "m", 3) for end in (swing[j].min(), swing[j].max()))
        correlation = number(round(float(found["dte_peak_to_peak_rank_correlation"][j]), 2), 2)
        shown.add_row(str(found["input"].to_numpy()[j]), str(found.attrs["written"][j]), *moved, correlation)
    console.print(shown)
    counts = ("refused", "contact_lost", "unstable")
    console.print(
        f"{samples} samples, seed {seed}: "
        + ", ".join(f"{found.attrs[name]} {name.replace('_', ' ')}" for name in counts)
    )
    files.write(found)

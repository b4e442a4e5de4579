"""spurcheck reversal: does the velocity over which friction changes its sign matter?"""

from __future__ import annotations

from typing import Annotated

import typer

from validation.commands import options as opt
from validation.commands.terminal import guarded, progress_bar, stdout, table


@guarded
def reversal(
    pair: opt.PairArgument = opt.DEFAULT_PAIR,
    cycles: Annotated[int, typer.Option(help="Mesh cycles to run.")] = 4,
    speed: opt.Speed = "800",
    torque: opt.Torque = "79.1",
    law: opt.Law = "coulomb",
    settings: opt.Settings = None,
) -> None:
    """Show how the multibody motion converges as friction changes its sign ever more sharply.

    At low speed friction that jumps at the pitch point can hold the teeth at zero sliding, where sign() has
    no solution; there friction changes its sign over a small sliding velocity. The table halves that
    velocity and states what each halving still changes, over the peak to peak of the motion.

    [bold]Examples[/bold]

    spurcheck reversal

    spurcheck reversal fzg_c --speed 650 --torque 135 --law benedict_kelley
    """
    from multibody.study.reversal_convergence import reversal_convergence
    from validation.reporting.formatting import number

    gear_pair = opt.gear_pair(pair, speed, torque, law, settings)
    with progress_bar("reversal") as tell:
        result = reversal_convergence(gear_pair, cycles, progress=tell)
    shown = table(
        f"{gear_pair.name}: change by the next halving of the velocity, over peak to peak",
        ">velocity [mm/s]",
        *(f">{quantity}" for quantity in result["quantity"].to_numpy()),
        ">order, dte",
        ">calls per cycle",
    )
    for velocity in result["velocity"].to_numpy():
        row = result.sel(velocity=velocity)
        shown.add_row(
            number(1e3 * float(velocity)),
            *(number(float(change), 3) for change in row["change"]),
            number(float(row["order"].sel(quantity="dte")), 2),
            number(float(row["force_evaluations"]), 4),
        )
    stdout().print(shown)

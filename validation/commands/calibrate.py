"""spurcheck calibrate: what records of a rig say about the assumed inputs of a pair."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from validation.commands import options as opt
from validation.commands.terminal import guarded, note, print_json, progress_bar, show, stdout

if TYPE_CHECKING:
    from validation.calibrate.posterior import Posterior

Records = Annotated[
    list[str] | None,
    typer.Argument(
        metavar="RECORD...",
        help="Measured records: .toml that describes a data file, or a data file. Several speeds and torques "
        "tell more than one.",
        show_default=False,
    ),
]


@guarded
def calibrate(
    pair: opt.Pair,
    records: Records = None,
    output: Annotated[
        Path | None, opt.output("Parameter file of the fitted pair to write: .toml; or its figure: .png.")
    ] = None,
    discrepancy: Annotated[
        bool,
        typer.Option(
            "--discrepancy/--no-discrepancy",
            help="Allow the model to be off in each order; without it the ranges are too narrow.",
        ),
    ] = True,
    next_test: Annotated[
        bool,
        typer.Option(
            "--next-test/--no-next-test", help="Say which test would leave least of the ranges of page 1."
        ),
    ] = True,
    machines: int = 64,
    seed: int = 1,
    supports: opt.Supports = None,
    as_json: opt.Json = False,
    force: opt.Force = False,
) -> None:
    """Say what records of a rig tell about the assumed values of a gear pair, and what they do not tell.

    The values of all uncertain inputs are searched with which the pair moves as in the records, in every form
    of the model: stiffness model, contact, friction law. The fitted file has the possible machines that are
    left; 'spurcheck report', 'uncertainty' and 'compare' take their ranges from them.

    [bold]Examples[/bold]
    spurcheck calibrate mypair.toml run12.toml -o fitted.toml
    spurcheck calibrate mypair.toml run12.toml run13.toml run14.toml -o fitted.toml

    Parameters
    ----------
    machines : Number of possible machines in the fitted file.
    seed : Start of the random numbers: the same seed gives the same machines.
    """
    from lumped.errors import refuse
    from validation.calibrate import calibrate as run
    from validation.files.output import check_file, write_text

    if not records:
        action = "For example: spurcheck calibrate mypair.toml run12.toml -o fitted.toml."
        raise refuse("RECORD", "missing", "at least one record", action)
    if output is not None:
        check_file(output, (".toml", ".png", ".svg", ".pdf"), force=force)
    with progress_bar("calibration") as tell:
        posterior = run(
            pair, records, discrepancy, machines=machines, seed=seed, supports=supports, progress=tell
        )
    if as_json:
        print_json(_as_json(posterior, next_test))
    else:
        _show(posterior)
        if next_test:
            for line in posterior.recommendation:
                stdout().print(line)
    if output is None:
        note("Not written: -o fitted.toml writes the fitted pair.")
    elif output.suffix.lower() == ".toml":
        write_text(output, posterior.text(next_test=next_test), new=not force)
        stdout().print(f"fitted pair: {output}")
    else:
        from validation.plots.style import save

        save(posterior.plot(), output, new=not force)
        stdout().print(f"figure: {output}")


def _show(posterior: Posterior) -> None:
    """Print the inputs, the forms of the model, what nothing explains, and page 1."""
    from validation.files.formatting import number
    from validation.prediction.motion import QUANTITIES

    console = stdout()
    for line in posterior.sentences:
        console.print(line)
    table = posterior.table
    rows = []
    for name in sorted(posterior.shares, key=lambda one: posterior.shares[one]):
        of_input = table.sel(input=name)
        before, after = (
            " .. ".join(number(float(one), 3) for one in of_input[key].to_numpy()[[0, -1]])
            for key in ("before", "after")
        )
        unit = str(of_input["unit"].item())
        share = 100.0 * posterior.shares[name]
        words = "" if bool(of_input["identified"]) else "not known by the records"
        rows.append((name, "" if unit == "1" else unit, before, after, f"{share:.0f}", words))
    show("", "input | unit | 5 to 95 % before | after | >width left, % | ", rows)
    forms = [
        (field, name, f"{100.0 * share:.0f}")
        for field, names in posterior.forms.items()
        for name, share in names.items()
    ]
    if forms:
        show("", "form of the model | | >probability, %", forms)
    results = []
    for name, (unit, words) in QUANTITIES.items():
        values = posterior.results[f"{name}_percentile"].to_numpy()
        results.append((words, unit, *(number(float(one), 4) for one in values)))
    show("", "at the operating point | unit | >5 % | >50 % | >95 %", results)


def _as_json(posterior: Posterior, next_test: bool) -> dict[str, Any]:
    """Return the numbers as JSON data, with the candidates of the next test where they are asked for."""
    from validation.calibrate.data import words_of

    table = posterior.table
    return {
        "records": words_of(posterior.records),
        "identified": posterior.identified,
        "not_identified": list(posterior.not_identified),
        "forms": posterior.forms,
        "discrepancy": posterior.level,
        "pareto_shape": posterior.pareto_shape,
        "unexplained": [one._asdict() for one in posterior.unexplained],
        "inputs": {
            str(name): {
                "unit": str(table["unit"].sel(input=name).item()),
                "before": table["before"].sel(input=name).to_numpy().tolist(),
                "after": table["after"].sel(input=name).to_numpy().tolist(),
                "share": float(table["share"].sel(input=name)),
            }
            for name in table["input"].to_numpy()
        },
        "results": {
            name: posterior.results[f"{name}_percentile"].to_numpy().tolist()
            for name in ("dte_peak_to_peak", "dynamic_factor", "tooth_load", "least_force", "bearing_rms")
        },
        "next_tests": [asdict(one) for one in posterior.next_tests] if next_test else [],
    }

"""spurcheck crosscheck: the lumped model against the multibody model, for a pair or a grid."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from validation.commands import options as opt
from validation.commands.terminal import conclude, guarded, print_json, progress_bar, stderr, stdout, table

if TYPE_CHECKING:
    from collections.abc import Mapping

    from rich.table import Table
    from rich.text import Text

    from validation.cross_check.agreement import Agreement
    from validation.cross_check.comparison import CrossCheck

_SUFFIXES = (".json", ".png", ".svg")


@guarded
def crosscheck(
    pair: opt.PairArgument = opt.DEFAULT_PAIR,
    output: Annotated[
        Path | None,
        opt.output(
            "All metrics as .json, or the transmission errors as .png or .svg; with --grid the dataset as "
            ".nc or .csv, or the heat map as .png or .svg."
        ),
    ] = None,
    grid: Annotated[
        bool,
        typer.Option(
            "--grid",
            help="Compare over all presets, friction laws, stiffness models, three speeds and two torques "
            "instead of one pair; takes minutes.",
        ),
    ] = False,
    checkpoint: Annotated[
        Path | None,
        typer.Option(
            help="With --grid: a folder that keeps every finished part, so that the same command goes on "
            "after an interruption.",
        ),
    ] = None,
    cycles: Annotated[int, typer.Option(help="Mesh cycles to run.")] = 40,
    samples: Annotated[int, typer.Option(help="Output times per mesh cycle.")] = 256,
    strict: Annotated[bool, typer.Option("--strict", help="Also fail on 'explained'.")] = False,
    speed: opt.Speed = None,
    torque: opt.Torque = None,
    law: opt.Law = None,
    settings: opt.Settings = None,
    as_json: opt.Json = False,
    force: opt.Force = False,
) -> None:
    """Check the lumped model against the independent multibody model.

    At fidelity linear both models hold the same equations and must agree to integration error. At fidelity
    exact the gears turn through finite angles with true involute contact; the difference shows what the
    lumped model leaves out.

    Verdicts: [bold]confirmed[/bold], every difference is within its own limit; [bold]explained[/bold], one
    is not, but finite motions account for it; [bold]not confirmed[/bold]: exit code 1.

    [bold]Examples[/bold]

    spurcheck crosscheck

    spurcheck crosscheck my_pair.toml --speed 4000 --strict -o agreement.json

    spurcheck crosscheck --grid -o grid.nc --checkpoint grid
    """
    if grid:
        given = {"PAIR": pair != opt.DEFAULT_PAIR, "--speed": speed, "--torque": torque, "--law": law}
        _grid(output, checkpoint, [k for k, v in (given | {"--set": settings}).items() if v], strict, force)
        return
    from lumped.errors import refuse
    from validation.cross_check.comparison import crosscheck as run
    from validation.files.output import check_file

    if checkpoint is not None:
        raise refuse("--checkpoint", checkpoint, "only with --grid", "One pair takes seconds: leave it out.")
    target = None if output is None else check_file(output, _SUFFIXES, force=force)
    gear_pair = opt.gear_pair(pair, speed, torque, law, settings)
    with progress_bar("cross-check") as tell:
        check = run(gear_pair, cycles=cycles, samples_per_cycle=samples, progress=tell)
    if as_json:
        print_json(_data(check))
    else:
        _print(check)
    if target is not None:
        _write(check, target, force)
        stderr().print(f"wrote {target}")
    conclude(check.verdict, strict=strict, tell=not as_json)


def _print(check: CrossCheck) -> None:
    from validation.cross_check.parted_motion import why_teeth_pull
    from validation.reporting.formatting import number

    console = stdout()
    for shown in _tables(check):
        console.print(shown)
    console.print(
        "linear: largest difference over the peak to peak of the lumped history. exact: norms over the norm "
        "of the lumped history of the whole difference (raw), of what finite motions must change by the "
        "lumped model alone (predicted), and of what they leave (left)",
        soft_wrap=True,
    )
    if check.finite_motion is not None and not check.finite_motion.settled:
        console.print(
            "Friction may hold the teeth at zero sliding: the effect of the actual sliding velocity is not "
            "predicted, so the most that it can change is allowed in what is left.",
            soft_wrap=True,
        )
    if check.failures and check.orbit is None and (why := why_teeth_pull(check.pair)):
        console.print(why, soft_wrap=True)
    for failure in check.failures:
        text = f"fails: {failure.check} {number(failure.value, 3)}, limit {number(failure.limit, 3)}"
        console.print(f"{text} ({failure.reason})", soft_wrap=True, markup=False)


def _data(check: CrossCheck) -> Any:
    """Verdict, failures and agreements as plain data; a limit that is infinite becomes null."""
    from dataclasses import asdict

    from validation.reporting.blocks import plain

    def finite(data: Any) -> Any:
        if isinstance(data, dict):
            return {key: finite(value) for key, value in data.items()}
        return [finite(value) for value in data] if isinstance(data, list) else plain(data)

    return finite(
        {
            "verdict": check.verdict,
            "failures": [asdict(failure) for failure in check.failures],
            "agreements": [asdict(a) | {"judged": a.judged, "within": a.within} for a in check.agreements],
        }
    )


def _tables(check: CrossCheck) -> list[Table]:
    from validation.cross_check.nature import nature_groups
    from validation.reporting.formatting import number

    def verdict(agreement: Agreement) -> Text:
        kept = "within" if all(j.within for j in agreement.raw) else "explained"
        return _word(all(j.within for j in agreement.judgements), kept)

    name = check.pair.name
    linear = table(f"{name}: linear", "quantity", ">difference", ">limit", "verdict")
    for a in check.of("linear"):
        linear.add_row(a.quantity, number(a.judged, 3), number(a.tolerance.limit, 3), verdict(a))
    exact = table(f"{name}: exact", "quantity", ">raw", ">limit", ">predicted", ">left", ">limit", "verdict")
    for a in check.of("exact"):
        limit = math.nan if a.whole_limit is None else a.whole_limit
        values = a.relative_l2, limit, a.predicted_l2, a.remainder_l2, a.tolerance.limit
        exact.add_row(a.quantity, *(number(value, 2) for value in values), verdict(a))
    nature = table(f"{name}: laws of nature", "check", ">value", ">limit", "verdict")
    for group in nature_groups(check.nature):
        nature.add_row(group.check, number(group.value, 2), number(group.limit, 2), _word(group.within))
    tables = [linear, exact, nature] if check.nature else [linear, exact]
    if check.twin is not None:
        g = check.twin.pair
        title = f"{name}: unlike twin, {g.pinion.teeth}/{g.gear.teeth} teeth, four unlike bearings"
        other = table(title, "worst", ">value", ">limit", "verdict")
        for worst in check.twin.worst_of_each:
            other.add_row(worst.check, number(worst.value, 2), number(worst.limit, 2), _word(worst.within))
        tables.append(other)
    return tables


def _word(within: bool, kept: str = "within") -> Text:
    from rich.text import Text

    return Text(kept, "green") if within else Text("outside", "red")


def _write(check: CrossCheck, target: Path, force: bool) -> None:
    from validation.cross_check.agreement import off_switch_samples
    from validation.files.output import write_text

    if target.suffix.lower() == ".json":
        write_text(target, json.dumps(_data(check), indent=1, allow_nan=False) + "\n", new=not force)
        return
    from validation.plots.cross_check import cross_check_figure
    from validation.plots.style import save

    keep = off_switch_samples(check.pair, check.lumped["time"].to_numpy())
    models = {str(fidelity): result for fidelity, result in check.multibody.items()}
    save(
        cross_check_figure(check.pair.geometry, "dte", "m", check.lumped, models, keep), target, new=not force
    )


def _grid(output: Path | None, checkpoint: Path | None, given: list[str], strict: bool, force: bool) -> None:
    """Run the grid, print a row for each pair and stiffness, write the dataset or the heat map."""
    from lumped.errors import refuse
    from validation.cross_check.grid.run import COMPARED
    from validation.cross_check.grid.run import crosscheck_grid as run
    from validation.cross_check.grid.summary import failures, law_of_torque, outside_tolerance, summarise_grid
    from validation.plots.grid import grid_figure
    from validation.reporting.formatting import number

    if given:
        raise refuse("--grid", " ".join(given), "no options of a single pair", "The grid covers all presets.")
    target = opt.figure_or_data(output, force=force)
    with progress_bar("grid") as tell:
        result = run(checkpoint=checkpoint, progress=tell)
    found = summarise_grid(result)
    if target is not None:
        opt.write_result(target, result, lambda: grid_figure(result), force=force)
    console = stdout()
    headings = (">judged", ">linear,\nof limit", ">exact,\nof limit", ">torque\nlaw off")
    shown = table("both models over the grid", "preset", "stiffness", *headings)
    for preset in result["preset"].to_numpy():
        for stiffness in result["stiffness"].to_numpy():
            part = result.sel(preset=preset, stiffness=stiffness)
            usage, judged = part["difference"] / part["limit"], part["status"] == COMPARED
            shown.add_row(
                str(preset),
                str(stiffness),
                f"{int(judged.sum())} of {judged.size}",
                number(float(usage.sel(fidelity="linear").max()), 2),
                number(float(usage.sel(fidelity="exact").where(judged).max()), 2),
                number(float(abs(law_of_torque(part) - 1.0).max()), 2),
            )
    console.print(shown)
    console.print(
        f"{found.points} points in {result.attrs['seconds']:.0f} s on {result.attrs['workers']} processes "
        f"({result.attrs['resumed']} kept from before): {found.compared} judged, {found.outside} outside; "
        f"not judged: {found.separated} without a stable motion of one mesh cycle, {found.sticking} with "
        f"sticking friction, {found.failed} failed"
    )
    for o in outside_tolerance(result):
        text = f"{o.quantity} left {o.left:.2g} of {o.whole:.2g}, limit {o.limit:.2g}"
        console.print(f"outside at {_named(o.point)}: {text}")
    for point, reason in failures(result):
        console.print(f"failed at {_named(point)}: {reason}")
    conclude(found.verdict, strict=strict)


def _named(point: Mapping[str, str | float]) -> str:
    return ", ".join(f"{axis} {value}" for axis, value in point.items())

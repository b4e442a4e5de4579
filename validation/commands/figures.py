"""spurcheck figures: the paper's figures 2 to 7, data beside each picture."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from validation.commands import options as opt
from validation.commands.terminal import guarded, progress_bar, stdout, table

if TYPE_CHECKING:
    from validation.paper import FigureRecord


@guarded
def figures(
    pair: opt.PairArgument = opt.DEFAULT_PAIR,
    output: Annotated[Path, opt.output("Folder to write, new or empty.")] = Path("spurcheck-figures"),
    only: Annotated[
        str | None,
        typer.Option("--figures", metavar="N,N", help="Only these figures, for example 2,4. Default: all."),
    ] = None,
    multibody: Annotated[
        bool,
        typer.Option("--multibody/--no-multibody", help="Give each curve of 4 to 7 its multibody twin."),
    ] = True,
    records: Annotated[
        list[Path] | None,
        typer.Option(
            "--measured",
            metavar="RECORD",
            help="Record of tooth forces (TOML) to lay over figure 7; as often as needed.",
        ),
    ] = None,
    settings: opt.Settings = None,
    force: opt.ForceFolder = False,
) -> None:
    """Reproduce figures 2 to 7 of the paper.

    One folder: each figure as SVG and PNG, its data as NetCDF and CSV, and figures.json with captions and the
    numbers read off. Speeds, torques, friction laws and flanks (without relief, in contact from A to D) are
    the paper's; the gear pair is the one given.

    [bold]Examples[/bold]

    spurcheck figures -o figures

    spurcheck figures --figures 2,7 --no-multibody --measured record.toml -o figures
    """
    from validation.files.folder import FIGURES, check_target, whole_folder
    from validation.measurements import load_measurement
    from validation.paper import DRAW, figure_records
    from validation.paper.operating_points import papers_pair

    check_target(output, force=force, kind=FIGURES)
    chosen = _chosen(only, tuple(DRAW))
    gear_pair = papers_pair(opt.gear_pair(pair, None, None, None, settings))
    measurements = [load_measurement(path) for path in records or []]
    with (
        progress_bar("figures") as tell,
        whole_folder(output, force=force, kind=FIGURES) as folder,
    ):
        made = figure_records(
            gear_pair, chosen, measurements=measurements, with_multibody=multibody, progress=tell
        )
        data = {
            "format": FIGURES.format,
            "gear_pair": gear_pair.name,
            "multibody": multibody,
            "figures": [_written(one, folder) for one in made],
            "parameters": gear_pair.to_mapping(),
        }
        text = json.dumps(data, indent=1, ensure_ascii=False, allow_nan=False)
        (folder / FIGURES.file).write_text(text + "\n", encoding="utf-8")
    console = stdout()
    for one in made:
        shown = table(f"figure {one.number}: {one.title}", "number", ">value")
        shown.columns[0].no_wrap = False
        shown.columns[1].no_wrap = False
        for name, value in one.numbers.items():
            shown.add_row(name, str(value))
        console.print(shown)
    console.print(f"figures: {output}")


def _chosen(text: str | None, known: tuple[str, ...]) -> tuple[str, ...]:
    """Numbers of figures out of "2,4"; each once, in the paper's order."""
    from lumped.errors import refuse

    if text is None:
        return known
    wanted = [part.strip() for part in text.split(",")]
    for name in wanted:
        if name not in known:
            raise refuse(
                "--figures", text, "numbers out of " + ", ".join(known), "For example --figures 2,4."
            )
    return tuple(name for name in known if name in wanted)


def _written(record: FigureRecord, folder: Path) -> dict[str, object]:
    """Write a figure and its data; return what figures.json says of it."""
    from validation.paper import DRAW
    from validation.plots.style import save

    drawn = DRAW[record.number](record)
    pictures = [folder / f"figure{record.number}.{form}" for form in ("svg", "png")]
    for path in pictures:
        save(drawn, path)
    return {
        "figure": record.number,
        "title": record.title,
        "text": record.text,
        "numbers": {
            name: {"value": one.value if math.isfinite(one.value) else None, "unit": one.unit}
            for name, one in record.numbers.items()
        },
        "pictures": [path.name for path in pictures],
        "data": [path.name for path in record.write(folder)],
    }

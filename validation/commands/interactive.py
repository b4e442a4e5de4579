"""spurcheck interactive: stability chart and response over speed to hover, zoom and slice."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from validation.commands import options as opt
from validation.commands.terminal import guarded, progress_bar, stderr


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

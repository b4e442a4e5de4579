"""spurcheck reference: public cases with curves beside which another model can be laid."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from validation.commands import options as opt
from validation.commands.terminal import guarded, show, stderr, stdout

Name = Annotated[str | None, typer.Argument(metavar="NAME", help="Name of a case, see --list.")]
Folder = Annotated[Path | None, opt.output("New folder for the parameter file, the curves and the figure.")]


@guarded
def reference(
    name: Name = None,
    output: Folder = None,
    list_: bool = False,
    force: opt.ForceFolder = False,
) -> None:
    """List the public reference cases, or write one of them: parameters, curves and a figure.

    A model of your own that is right gives the curves of a case. NAME.toml is the parameter file of the gear
    pair, NAME.csv has the curves over the period, NAME.case.toml says what they are, how well other programs
    reach them, and the state at t = 0. A case with one degree of freedom has its equation in NAME.case.toml
    and no parameter file. The data are in the public domain (CC0).

    [bold]Examples[/bold]
    spurcheck reference --list
    spurcheck reference mathieu
    spurcheck reference contact_lost_43_22 -o contact_lost

    Parameters
    ----------
    list_ : List all cases.
    """
    from lumped.errors import refuse
    from validation.reference_cases.case import reference as case_of
    from validation.reference_cases.case import reference_names
    from validation.reference_cases.discrepancy import percent
    from validation.reference_cases.output import write_case

    if name is None or list_:
        if output is not None:
            raise refuse(
                "NAME", "missing", "a case beside --output", "List the cases: spurcheck reference --list."
            )
        cases = [case_of(one) for one in ([name] if name else reference_names())]
        rows = [
            (
                case.name,
                len(case.curves.channels),
                case.mesh_cycles,
                case.curves.places.size,
                case.description,
            )
            for case in cases
        ]
        show("", "case | >channels | >mesh cycles | >samples | what it is", rows)
        return
    case = case_of(name)
    if output is not None:
        written = write_case(case, output, force=force)
        stderr().print("wrote " + ", ".join(str(path) for path in written))
        return
    console = stdout()
    console.print(f"{case.name}: {case.description}")
    console.print(f"A frequent fault that this case shows: {case.frequent_fault}")
    console.print(f"Source: {case.source}. Licence of the data: {case.licence}.")
    console.print(f"Curves: {case.curves_from}, {case.samples_per_cycle} samples a mesh cycle.")
    ways = [
        way
        for way in ("closed_form", "lumped", "floquet", "multibody")
        if any(getattr(one, way) is not None for one in case.discrepancy.values())
    ]
    rows_of_channels = [
        (channel, *(percent(getattr(one, way)) for way in ways)) for channel, one in case.discrepancy.items()
    ]
    head = "channel" + "".join(f" | >{way.replace('_', ' ')}" for way in ways)
    show("Discrepancy from the curves, share of the amplitude:", head, rows_of_channels)

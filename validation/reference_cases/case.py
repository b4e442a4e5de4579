"""Reference cases: gear pairs and equations with curves beside which another model can be laid.

Sources: docs/theory/equations.md and docs/theory/multibody.md; of one degree of freedom ``equations.py``.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, overload

from lumped import GearPair
from lumped.arguments import nearest
from lumped.display.result import DisplayedResult, no_variables
from lumped.errors import refuse
from lumped.fields.text_file import parse_toml
from lumped.schema.files import load_gear_pair
from validation.check.curves import Curves
from validation.reference_cases.discrepancy import Discrepancy
from validation.reference_cases.equations import SingleDegree, equation_of
from validation.reference_cases.files import (
    case_names,
    checked_text,
    curves_file,
    pair_file,
    read_curves,
    statement,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, eq=False, repr=False)
class ReferenceCase(DisplayedResult):
    """Reference case: a gear pair or an equation, its periodic motion, and how well other ways reach it.

    Attributes
    ----------
    name : name of the case
    description : one sentence: what is in the case
    frequent_fault : one sentence: a frequent fault of models that the case shows
    source : where the equations or the gears come from
    licence : licence of the data, "CC0-1.0"
    schema_version : version of the layout of the files
    pair : the gear pair; None for a case with one degree of freedom
    equation : the equation with one degree of freedom; None for a gear pair
    curves : curves over the period in SI; at t = 0 a tooth pair is at the start of contact A
    discrepancy : channel -> discrepancy of each way, a share of the amplitude of the channel
    curves_from : words: the way that made the curves
    samples_per_cycle : number of samples of a mesh cycle
    mesh_cycles : number of mesh cycles after which the motion repeats
    mesh_period : mesh cycle [s]
    start : state at t = 0: variable -> value in SI; empty on shafts, which have states of their own
    """

    shown: ClassVar = (
        "name",
        "description",
        "frequent_fault",
        "source",
        "curves_from",
        "mesh_cycles",
        "samples_per_cycle",
        "mesh_period",
        "start",
        "licence",
    )

    name: str
    description: str
    frequent_fault: str
    source: str
    licence: str
    schema_version: int
    pair: GearPair | None
    equation: SingleDegree | None
    curves: Curves
    discrepancy: Mapping[str, Discrepancy]
    curves_from: str
    samples_per_cycle: int
    mesh_cycles: int
    mesh_period: float
    start: Mapping[str, float]

    def plot(self, *variables: object) -> Figure:
        """Draw every channel over the period."""
        no_variables(variables)
        from validation.reference_cases.figure import case_figure

        return case_figure(self.curves, self.mesh_period, self.mesh_cycles)


def reference_names() -> tuple[str, ...]:
    """Return the names of the reference cases, from one degree of freedom to elastic shafts."""
    return case_names()


@overload
def reference(name: str) -> ReferenceCase: ...


@overload
def reference(name: None = None) -> tuple[str, ...]: ...


def reference(name: str | None = None) -> ReferenceCase | tuple[str, ...]:
    """Return a reference case: a gear pair with curves beside which another model can be laid.

    Parameters
    ----------
    name : name of the case. None: the names of all cases are returned

    Returns
    -------
    ReferenceCase, or the names of all cases

    Raises
    ------
    ParameterError : no case has this name
    StorageError : a file of the case was changed since it was published
    """
    if name is None:
        return reference_names()
    if not isinstance(name, str) or name not in case_names():
        near = nearest(str(name), case_names()) or "List the cases: spurcheck reference --list."
        raise refuse("reference case", name, "one of " + ", ".join(case_names()), near)
    stated = statement(name)
    has_pair = bool(stated["pair"])
    file = pair_file(name)
    pair = load_gear_pair(parse_toml(checked_text(file), file)) if has_pair else None
    operating = None if pair is None else pair.operating
    curves = read_curves(
        checked_text(curves_file(name)),
        name,
        pinion_speed=None if operating is None else operating.pinion_speed,
        pinion_torque=None if operating is None else operating.pinion_torque,
    )
    sampling = stated["sampling"]
    discrepancy = {
        channel: Discrepancy(**values)
        for channel, values in stated["discrepancy"].items()
        if channel != "meaning"
    }
    return ReferenceCase(
        name=stated["name"],
        description=stated["description"],
        frequent_fault=stated["frequent_fault"],
        source=stated["source"],
        licence=stated["licence"],
        schema_version=stated["schema_version"],
        pair=pair,
        equation=None if has_pair else equation_of(stated["equation"]),
        curves=curves,
        discrepancy=discrepancy,
        curves_from=stated["motion"]["curves_from"],
        samples_per_cycle=sampling["samples_per_cycle"],
        mesh_cycles=sampling["mesh_cycles"],
        mesh_period=sampling["mesh_period"],
        start=stated["start"],
    )

"""The gear stages of a REXS file, and which of them spurcheck can model."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from lumped.arguments import whole_number
from lumped.errors import FieldProblem, ParameterError, refuse, shown
from lumped.fields.units import to_stated
from validation.exchange.rexs.draft import Draft
from validation.exchange.rexs.encodings import read_rexs
from validation.exchange.rexs.model import Component, RexsModel, broken

_GEARS = ("cylindrical_gear", "ring_gear", "bevel_gear", "worm_gear", "worm_wheel")
#: Helix angles below this are what a program leaves of a zero [deg].
_NO_HELIX = 1e-9


@dataclass(frozen=True)
class Stage:
    """One gear stage of a REXS file.

    Attributes
    ----------
    number : 1, 2, ... in the order of the file; what ``stage`` of ``gear_pair_from_rexs`` means
    component_id : id of the stage's component
    name : as the file says
    kind : component type
    teeth : of its gears, where the file has them
    reason : what it is instead, and after "; " why spurcheck cannot model that; or ""
    """

    number: int
    component_id: int
    name: str
    kind: str
    teeth: tuple[int, ...]
    reason: str = ""

    @property
    def usable(self) -> bool:
        """Whether it is a spur stage of two external gears."""
        return not self.reason

    def __str__(self) -> str:
        teeth = "/".join(map(str, self.teeth)) or "teeth not given"
        verdict = f" - {self.reason}" if self.reason else ""
        return f"{self.number}: {self.name or self.kind} ({teeth}){verdict}"


def rexs_stages(path: str | Path) -> list[Stage]:
    """List the gear stages of a REXS file, in its order.

    Parameters
    ----------
    path : XML, JSON or ZIP form

    Raises
    ------
    ParameterError : the file cannot be read
    """
    return _stages_of(read_rexs(path))


def _stages_of(model: RexsModel) -> list[Stage]:
    # A planetary stage counts only where its parts are not in the file.
    stages = [
        c
        for c in model.components.values()
        if c.type.endswith("_stage")
        and not model.related(c, "assembly", "assembly", "part", "cylindrical_stage")
    ]
    return [
        Stage(
            number,
            c.id,
            c.name,
            c.type,
            tuple(z for gear in gears_of(model, c) if (z := _teeth(gear)) is not None),
            _reason(model, c, gears_of(model, c)),
        )
        for number, c in enumerate(stages, 1)
    ]


def gears_of(model: RexsModel, stage: Component) -> list[Component]:
    """Return gear_1 and gear_2 of a stage, in this order."""
    roles = ("gear_1", "gear_2")
    return [gear for role in roles for gear in model.related(stage, "stage", "stage", role, *_GEARS)]


def chosen(model: RexsModel, number: int | None) -> tuple[Stage, list[str]]:
    """Return the stage to import, and notes about the choice.

    Raises
    ------
    ParameterError : there is none, it cannot be modelled, or several can and no number was given
    """
    stages = _stages_of(model)
    if not stages:
        raise broken(model.file, "it has no gear stage")
    if number is not None:
        stages = [stages[whole_number("stage", number, 1, len(stages)) - 1]]
    listed = "; ".join(map(str, stages))
    usable = [stage for stage in stages if stage.usable]
    if len(usable) > 1:
        raise refuse("stage", "not given", f"one of {listed}", "Choose a stage by its number.")
    if not usable:
        wanted = "a cylindrical stage of two external spur gears"
        problems = []
        for stage in stages:
            kind, _, why = stage.reason.partition("; ")
            action = f"{why[:1].upper()}{why[1:]}."
            problems.append(FieldProblem(f"stage {stage.number}", kind, wanted, action))
        raise ParameterError(problems, model.file)
    notes = [] if len(stages) == 1 else [f"stage {usable[0].number} is the only spur stage of: {listed}"]
    return usable[0], notes


def _teeth(gear: Component) -> int | None:
    found = gear.attributes.get("number_of_teeth")
    try:
        return None if found is None or found.value is None else int(str(found.value))
    except ValueError:
        return None


def _reason(model: RexsModel, stage: Component, gears: list[Component]) -> str:
    """Why a stage cannot be modelled."""
    if stage.type != "cylindrical_stage":
        return f"a {shown(stage.type.replace('_', ' '))}; only cylindrical spur stages can be modelled"
    if model.related(stage, "assembly", "part", "assembly", "planetary_stage"):
        return "a mesh of a planetary stage; the planets share the load, one pair alone cannot stand for it"
    if any(gear.type == "ring_gear" or (_teeth(gear) or 0) < 0 for gear in gears):
        return "a stage with an internal gear; the model is of two external gears"
    if len(gears) != 2 or any(gear.type != "cylindrical_gear" for gear in gears):
        kinds = " and ".join(shown(gear.type.replace("_", " ")) for gear in gears) or "no gear"
        return f"a stage of {kinds}; its 'stage' relation has to name two cylindrical gears"
    for gear in gears:
        helix = Draft(model).number(gear, "helix_angle_reference_diameter")
        angle = 0.0 if helix is None else to_stated(helix.si, "deg")
        if abs(angle) > _NO_HELIX:
            return (
                f"a helical stage, helix angle {angle:g} deg in {gear.label}; the plane model has neither "
                "axial forces nor contact lines that run across the face width"
            )
    return ""

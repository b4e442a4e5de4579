"""The schema of a gear pair: one frozen, validated, hashable model shared by every part of spurcheck.

Values are SI inside. In files and keyword arguments a bare number means the field's stated unit and a string
may carry any unit of that dimension (``lumped.fields.units``).
"""

from __future__ import annotations

import html
import math
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from dataclasses import replace
from functools import cached_property, lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, NoReturn

from pydantic import BeforeValidator, Field, PlainSerializer, model_validator
from pydantic.fields import FieldInfo

from lumped.errors import FieldProblem, ParameterError, refuse
from lumped.faults.base import Flank
from lumped.fields.refusals import field_of, made_of
from lumped.fields.section import Section, Text
from lumped.fields.units import Quantity, to_si, to_stated
from lumped.friction.base import ContactPath
from lumped.friction.registry import law_of
from lumped.friction.table import TABLE
from lumped.gear_geometry.geometry import (
    Geometry,
    Wheel,
    build_geometry,
    existence_problems,
    theoretical_backlash,
)
from lumped.gear_geometry.profile_shift import (
    LARGEST_SHIFT,
    LEAST_SHIFT,
    distance_without_backlash,
    resolved_shifts,
    shift_sum,
    tip_alteration,
)
from lumped.gear_geometry.tooth_profile import ToothProfile
from lumped.schema import own_laws
from lumped.schema.advice import Changes, advised
from lumped.schema.assumed import ABOUT, Assumed, AssumedTable, State, problems_of, recorded
from lumped.schema.bearings import Bearings
from lumped.schema.changes import SHORT_NAMES, by_fields, changed
from lumped.schema.contact import Lubricant, Mesh, without_assumed_defaults
from lumped.schema.friction import Friction, nominal_contact
from lumped.schema.gear import BasicRack, Gear
from lumped.schema.old_formats import FORMAT, upgraded
from lumped.schema.operating import LARGEST_SPEED as LARGEST_SPEED
from lumped.schema.operating import OperatingPoint as OperatingPoint
from lumped.schema.posterior import ERROR, PosteriorTable, problems_of_columns
from lumped.schema.shafts import Shafts
from lumped.schema.value_changes import ValueChanges, value_changes

#: Name that a pair does not have -> what to write.
_INSTEAD = {
    "ratio": "pair.gear.teeth / pair.pinion.teeth",
    "gear_ratio": "pair.gear.teeth / pair.pinion.teeth",
    "summary": "print(pair), pair.geometry, or pair.to_toml()",
    **dict.fromkeys(("save", "write", "to_file"), "Path(...).write_text(pair.to_toml())"),
    **dict.fromkeys(("to_dict", "as_dict"), "pair.to_mapping()"),
    **dict.fromkeys(("replace", "update", "set", "change", "vary"), "pair.with_(speed=2000)"),
    **dict.fromkeys(("plot", "simulate", "run", "predict"), "spurcheck.predict(pair).plot()"),
    **dict.fromkeys(("report",), "spurcheck.report(pair, 'folder')"),
    "contact_ratio": "pair.geometry.contact_ratio",
    "mesh_frequency": "1 / pair.geometry.mesh_period",
}


#: Gears as cut: samples of uncertain tips have a few in common, with what was computed of their teeth.
_cut = lru_cache(maxsize=256)(Wheel)
#: Problems that a wrong centre distance may cause.
_OF_THE_MESH = ("centre_distance", "contact_ratio", "pinion.tip_diameter", "gear.tip_diameter")
#: Largest normal backlash over module at a centre distance, of teeth as cut. The allowances of ISO/TR 10064-2
#: are at most half of this backlash, and the centre distance has tolerances too.
_LARGEST_PLAY = 0.2
#: Fields that a stiffness decides, unless their values are known.
_BESIDE = ("mesh.contact", "mesh.relief")
#: Least mass and inertia of a gear as a share of the solid disc's.
_LIGHTEST = 1e-4


def _pairs_in(value: object) -> object:
    """A table of texts or lists of texts, as pairs in order."""
    if not isinstance(value, dict):
        return value
    return tuple(sorted((path, tuple(s) if isinstance(s, list) else s) for path, s in value.items()))


Sources = Annotated[
    tuple[tuple[str, str], ...],
    BeforeValidator(_pairs_in, json_schema_input_type=dict[str, str]),
    PlainSerializer(dict, return_type=dict[str, str]),
]


Spreads = Annotated[
    tuple[tuple[str, str | tuple[str, ...]], ...],
    BeforeValidator(_pairs_in, json_schema_input_type=dict[str, str | list[str]]),
    PlainSerializer(
        lambda spreads: {path: list(s) if isinstance(s, tuple) else s for path, s in spreads},
        return_type=dict[str, str | list[str]],
    ),
]


class _InOurWords(type(Section)):  # type: ignore[misc]  # pydantic's metaclass
    """Metaclass: a call of the class refuses like a parameter file, with field, value and what to do."""

    def __call__(cls, *args: Any, **fields: Any) -> Any:
        if args:
            raise refuse("pair", args[0], "field=value", "Use load_gear_pair(...) or new_pair(...).")
        return validated(fields, "GearPair")


class GearPair(Section, metaclass=_InOurWords):
    """A spur gear pair with everything that spurcheck needs to know about it."""

    name: Text = Field(min_length=1, max_length=80, description="short name")
    description: Text = Field("", max_length=2000, description="what this pair is")
    basic_rack: BasicRack
    pinion: Gear = Field(description="the driving gear")
    gear: Gear = Field(description="the driven gear")
    centre_distance: Annotated[float | None, Quantity("mm", above=0, optional=True)] = Field(
        None, description="centre distance; default free of backlash for the profile shifts"
    )
    bearings: Bearings = Field(description="what holds the gears in the 6-DOF model")
    shafts: Shafts | None = Field(None, description="the shafts that bear the gears, where they are known")
    mesh: Mesh
    lubricant: Lubricant
    friction: Friction
    operating: OperatingPoint
    sources: Sources = Field((), description="field path -> where its value comes from, in your own words")
    assumed: AssumedTable = Field(
        default_factory=Assumed,
        description="field path -> the value that is assumed; a field with another value, or without an "
        "entry, is known",
    )
    uncertainty: Spreads = Field(
        (),
        description="field path -> how far its value may be off: '0.02 .. 0.10', '+- 2 um', '+- 10 %', "
        "'/ 2 .. * 2', or a list of choices",
    )
    posterior: PosteriorTable = Field(
        (),
        description="field path -> values in the possible machines that measured records leave, the first of "
        "the best fit; spurcheck calibrate writes it",
    )

    @model_validator(mode="before")
    @classmethod
    def _stiffness_decides_again(cls, data: Any) -> Any:
        """Contact and relief that a file has as assumed defaults are left to its stiffness."""
        return without_assumed_defaults(data, {"contact": "loaded", "relief": "static"})

    @model_validator(mode="after")
    def _must_exist(self) -> GearPair:
        self._parts_fit(self._problems_of_existence())
        wrong = [problem for path, _ in self.sources for problem in _path_problems(path, "sources")]
        wrong += [problem for path, _ in self.uncertainty for problem in _path_problems(path, "uncertainty")]
        wrong += problems_of(type(self), self.assumed)
        columns = [path for path, _ in self.posterior if not path.startswith(ERROR)]
        wrong += [problem for path in columns for problem in _path_problems(path, "posterior")]
        wrong += problems_of_columns(self.posterior)
        if wrong:
            raise ParameterError(wrong)
        return self._completed()

    def _problems_of_existence(self) -> list[FieldProblem]:
        problems = existence_problems(*self.wheels, self.geometry, self.mesh.backlash)
        return self._of_contradicting_sizes(advised(self, list(problems)))

    def _parts_fit(self, problems: list[FieldProblem]) -> None:
        """Refuse the problems of existence, with those of masses, tables, single teeth and relief."""
        problems = [*problems, *self._too_light("pinion"), *self._too_light("gear")]
        if self.friction.law == TABLE and self.friction.table is not None and not problems:
            problems += self.friction.table.problems(self.geometry)
        problems += [*self._missing_teeth("pinion", 0), *self._missing_teeth("gear", 1)]
        problems += [*self._relief_counted_twice()]
        if problems:
            raise ParameterError(problems, self.name)

    def _completed(self) -> GearPair:
        """Set what the geometry decides: where reliefs start, and the load of rolling bearings."""
        for index, name in enumerate(("pinion", "gear")):
            self.__dict__[name] = self._with_relief(name, index)
        force = self.operating.pinion_torque / self.geometry.base_radius_pinion
        self.__dict__["bearings"] = self.bearings.under(force)
        return self

    def meshes_with(self, changes: Changes) -> bool:
        """Whether the gears can mesh with changed fields, for example {"pinion": {"teeth": 19}}, in SI."""
        sections = {field: getattr(self, field) for field in type(self).model_fields}
        sections |= {name: getattr(self, name).model_copy(update=dict(new)) for name, new in changes.items()}
        tried = GearPair.model_construct(**sections)
        try:
            return not existence_problems(*tried.wheels, tried.geometry, tried.mesh.backlash)
        except ParameterError:
            return False

    @model_validator(mode="after")
    def _records_what_it_assumes(self) -> GearPair:
        self.__dict__["assumed"] = recorded(self, self.assumed, self._assumed_sizes())  # nobody has it yet
        return self

    def _assumed_sizes(self) -> dict[str, float]:
        """Path -> value in file units of each assumed profile shift and tip alteration.

        The value is assumed where neither the file nor another input decides. A profile shift that follows
        from the centre distance and the other profile shift is known.
        """
        gears = {"pinion": self.pinion, "gear": self.gear}
        assumed: dict[str, float] = {}
        free = [name for name, gear in gears.items() if gear.profile_shift is None]
        if self.centre_distance is None or len(free) > 1:
            assumed |= {
                f"{name}.profile_shift": shift
                for name, shift in zip(gears, self.profile_shifts, strict=True)
                if name in free
            }
        for name, gear in gears.items():
            if gear.tip_diameter is None and gear.addendum is None and gear.tip_alteration is None:
                assumed[f"{name}.tip_alteration"] = to_stated(self.tip_alteration, "mm")
        return assumed

    def state(self, field: str) -> State:
        """Return whether the value of a field is known or assumed; see ``assumed``.

        Parameters
        ----------
        field : dotted path, "mesh.backlash"

        Raises
        ------
        ParameterError : a name that is no field; the refusal suggests the nearest field
        """
        field_at(field)
        return State.ASSUMED if field in self.assumed else State.KNOWN

    @cached_property
    def geometry(self) -> Geometry:
        """Circles, line of action, contact ratio and mesh period, SI; built once."""
        try:
            return self._geometry_at(self.centre_distance)
        except ParameterError as error:
            raise ParameterError(self._of_contradicting_sizes(list(error.problems)), self.name) from None

    def _geometry_at(self, centre_distance: float | None) -> Geometry:
        speed = self.operating.pinion_speed
        return build_geometry(*self.wheels, centre_distance, self.mesh.backlash, speed)

    def _of_contradicting_sizes(self, problems: list[FieldProblem]) -> list[FieldProblem]:
        """Put a contradiction of centre distance and profile shifts in front of the problems.

        There is a contradiction where the teeth as cut would wedge, where the backlash would be larger than
        any allowance, or where the gears cannot mesh, but would mesh at the centre distance of the profile
        shifts.
        """
        shifts = self.pinion.profile_shift, self.gear.profile_shift
        if self.centre_distance is None or None in shifts:
            return problems
        if not problems and self._play(self.geometry) <= _LARGEST_PLAY * self.basic_rack.module:
            return problems
        sections = {name: getattr(self, name) for name in GearPair.model_fields}
        of_shifts = GearPair.model_construct(**sections | {"centre_distance": None})
        try:
            free = of_shifts._geometry_at(None)
        except ParameterError:
            return problems
        if existence_problems(*of_shifts.wheels, free, self.mesh.backlash):
            return problems
        value = f"{self.centre_distance * 1e3:.6g} mm with the profile shifts {shifts[0]:g} and {shifts[1]:g}"
        about = f"about {free.centre_distance * 1e3:.6g} mm for these shifts"
        allowed = f"normal backlash >= 0 and <= {_LARGEST_PLAY:g} modules, so {about}"
        try:
            play = self._play(self._geometry_at(self.centre_distance))
        except ParameterError as error:  # no geometry, so no backlash: a centre distance below the base radii
            allowed = f"{error.problems[0].allowed}, {about}"
        else:
            thinned = play + self.mesh.backlash
            value += (
                f", backlash {thinned * 1e3:.4f} mm: the teeth wedge"
                if thinned < 0.0
                else f", backlash {play * 1e3:.4f} mm"
            )
        if problems and not any(problem.field in _OF_THE_MESH for problem in problems):
            return problems
        rack = self.basic_rack
        teeth = self.pinion.teeth + self.gear.teeth
        actions = [f"Delete centre_distance (it is then {free.centre_distance * 1e3:.6g} mm)"]
        with suppress(ParameterError):  # a centre distance below that of the base circles
            total = shift_sum(teeth, rack.module, rack.pressure_angle, self.centre_distance)
            if 2.0 * LEAST_SHIFT <= total <= 2.0 * LARGEST_SHIFT:
                actions.append(f"or the profile shifts (their sum is then {total:.4f})")
        actions.append("or correct the wrong one. Teeth that are thinned on purpose: mesh.backlash")
        first = FieldProblem("centre_distance", value, allowed, f"{', '.join(actions)}.")
        return [first, *(problem for problem in problems if problem.field not in _OF_THE_MESH)]

    def _play(self, geometry: Geometry) -> float:
        """Backlash of the teeth as cut, without ``mesh.backlash`` [m]."""
        return theoretical_backlash(*self.wheels, geometry.operating_pressure_angle)

    @cached_property
    def wheels(self) -> tuple[Wheel, Wheel]:
        """Pinion and gear as cut by the basic rack, SI."""
        first, second = self.profile_shifts
        return self._wheel(self.pinion, first), self._wheel(self.gear, second)

    @cached_property
    def profile_shifts(self) -> tuple[float, float]:
        """Profile shift coefficients of pinion and gear: of the file, otherwise from the centre distance.

        See ``lumped.gear_geometry.profile_shift.resolved_shifts``.
        """
        rack = self.basic_rack
        gears = (self.pinion, self.gear)
        return resolved_shifts(
            (self.pinion.profile_shift, self.gear.profile_shift),
            (gears[0].teeth, gears[1].teeth),
            rack.module,
            rack.pressure_angle,
            self.centre_distance,
        )

    @cached_property
    def tip_alteration(self) -> float:
        """Default tip alteration k m [m], which keeps the clearance of the basic rack."""
        rack = self.basic_rack
        teeth = self.pinion.teeth + self.gear.teeth
        shift = sum(self.profile_shifts)
        centre = self.centre_distance
        if centre is None:
            centre = distance_without_backlash(teeth, rack.module, rack.pressure_angle, shift)
        return tip_alteration(centre, rack.module, teeth, shift)

    def _wheel(self, gear: Gear, shift: float) -> Wheel:
        rack = self.basic_rack
        sizes = rack.dedendum_coefficient, rack.fillet_radius_coefficient
        tooth = ToothProfile(gear.teeth, rack.module, rack.pressure_angle, shift, *sizes)
        if gear.tip_diameter is not None:
            tip = 0.5 * gear.tip_diameter
        elif gear.addendum is not None:
            tip = tooth.reference_radius + gear.addendum
        else:
            alteration = self.tip_alteration if gear.tip_alteration is None else gear.tip_alteration
            tip = tooth.reference_radius + rack.module * (rack.addendum_coefficient + shift) + alteration
        return _cut(tooth, tip, gear.face_width, gear.bore)

    def _with_relief(self, name: str, index: int) -> Gear:
        gear: Gear = getattr(self, name)
        if gear.tip_relief is None and gear.root_relief is None:
            return gear
        try:
            return gear.with_relief_on(self.flank(index))
        except ParameterError as error:
            problems = [replace(one, field=f"{name}.{one.field}") for one in error.problems]
            raise ParameterError(problems, self.name) from None

    def _too_light(self, name: Literal["pinion", "gear"]) -> Iterator[FieldProblem]:
        """Problems: a mass or inertia far too small for the gear.

        The vibration would take years to compute.
        """
        gear: Gear = getattr(self, name)
        radius = 0.5 * self.basic_rack.module * gear.teeth
        mass = gear.density * math.pi * radius**2 * gear.face_width
        for field, disc, unit in (("mass", mass, "kg"), ("inertia", 0.5 * mass * radius**2, "kg*m**2")):
            value = getattr(gear, field)
            if value is not None and value < _LIGHTEST * disc:
                allowed = f">= {_LIGHTEST * disc:.3g} {unit}, {_LIGHTEST:g} of the solid disc's"
                action = "Check the unit, or leave it out: the disc's is taken."
                yield FieldProblem(f"{name}.{field}", f"{value:g} {unit}", allowed, action)

    def _missing_teeth(self, name: Literal["pinion", "gear"], index: int) -> Iterator[FieldProblem]:
        """Problems: a first tooth that the gear does not have, faults that do not fit the teeth."""
        gear: Gear = getattr(self, name)
        if self.mesh.first_teeth is not None and self.mesh.first_teeth[index] > gear.teeth:
            value = f"{list(self.mesh.first_teeth)}"
            allowed = f"tooth of the {name} from 1 to {gear.teeth}"
            yield FieldProblem("mesh.first_teeth", value, allowed, "Name a tooth that the gear has.")
        for number, fault in enumerate(gear.faults):
            for one in fault.problems(self.flank(index)):
                yield replace(one, field=f"{name}.faults.{number}.{one.field}")

    def _relief_counted_twice(self) -> Iterator[FieldProblem]:
        """Problem: relief beside a stiffness of the whole mesh, which already includes the profile."""
        reliefs = [one for gear in (self.pinion, self.gear) for one in (gear.tip_relief, gear.root_relief)]
        acts = self.mesh.relief == "static" and any(one is not None and one.amount > 0.0 for one in reliefs)
        if self.mesh.stiffness.whole_mesh and acts:
            allowed = "'ignored' where mesh.stiffness is that of the whole mesh, which has the profile in it"
            action = (
                "Write mesh.relief = 'ignored', or leave it out: relief then counts once. If it is the curve "
                "of one tooth pair, write kind = 'pair' in mesh.stiffness: then relief = 'static' stays."
            )
            yield FieldProblem("mesh.relief", "static", allowed, action)

    @property
    def stiffness_words(self) -> str:
        """Words for the kind of stiffness in the file: of the whole mesh or of one tooth pair."""
        return self.mesh.stiffness.words

    @property
    def stiffness_note(self) -> str:
        """Sentence on a stiffness of the whole mesh; empty for a stiffness of a tooth pair."""
        if not self.mesh.stiffness.whole_mesh:
            return ""
        return (
            f"mesh.stiffness is the {self.stiffness_words}: contact is prescribed, and tip and root relief "
            "are part of the stiffness."
        )

    @property
    def nominal_contact(self) -> ContactPath:
        """Conditions of contact for friction laws, see ``lumped.path_of_contact.contact_path``."""
        gears = (self.pinion, self.gear)
        torque = self.operating.pinion_torque
        return nominal_contact(self.geometry, gears, self.lubricant, self.friction, torque)

    def flank(self, index: int) -> Flank:
        """The loaded flank of a tooth of the pinion (0) or the gear (1), for faults."""
        g = self.geometry
        gear = (self.pinion, self.gear)[index]
        moduli = [one.youngs_modulus / (1.0 - one.poisson_ratio**2) for one in (self.pinion, self.gear)]
        tip, start = ((g.tip_length_pinion, g.L_XA), (g.tip_length_gear, g.L_XY - g.L_XD))[index]
        hertz = 2.0 * (1.0 / moduli[0] + 1.0 / moduli[1]) / (math.pi * g.face_width)
        return Flank(self.wheels[index], tip, start, g.face_width, gear.youngs_modulus, hertz)

    @property
    def healthy(self) -> GearPair:
        """The pair with like teeth, centred gears and steady torques; the same object if nothing changes."""
        if not (self.pinion.has_own_teeth or self.gear.has_own_teeth or self.operating.torque_ripple):
            return self  # not cached: pairs are compared by their attributes, and a pair would contain itself
        return self._with_like_teeth

    @cached_property
    def _with_like_teeth(self) -> GearPair:
        none = {"deviations": None, "mounting": None, "faults": ()}
        gears = {name: getattr(self, name).model_copy(update=none) for name in ("pinion", "gear")}
        steady = self.operating.model_copy(update={"torque_ripple": ()})
        gone = [f"{gear}.{field}" for gear in gears for field in none]
        rest = {"operating": steady, "assumed": self.assumed.without(*gone, "operating.torque_ripple")}
        return GearPair.model_construct(
            **{name: getattr(self, name) for name in GearPair.model_fields} | gears | rest
        )

    def at_speed(self, rpm: float) -> GearPair:
        """The pair at another pinion speed [rpm] within the speed range of the pair, without a new check."""
        sections = {name: getattr(self, name) for name in GearPair.model_fields}
        sections["operating"] = self.operating.at_speed(to_si(rpm, "rpm"))
        sections["assumed"] = self.assumed.without("operating.pinion_speed")
        pair = GearPair.model_construct(**sections)
        pair.__dict__["geometry"] = self.geometry.at_speed(sections["operating"].pinion_speed)
        return pair

    if not TYPE_CHECKING:  # a checker knows the fields

        def __getattr__(self, name: str) -> Any:
            """Refuse a name that is no attribute, with the attribute for a short name of ``with_``."""
            if name in SHORT_NAMES:
                raise AttributeError(
                    f"a pair has no {name!r}: read pair.{' or pair.'.join(SHORT_NAMES[name])}"
                )
            if instead := _INSTEAD.get(name):
                raise AttributeError(f"a pair has no {name!r}: use {instead}")
            return super().__getattr__(name)

    def __repr__(self) -> str:
        """Return the pair in one line; ``to_toml()`` has every field."""
        pinion = self.pinion
        gear = self.gear
        operating = self.operating
        law = self.friction.law if self.friction.law != TABLE else law_of(self.friction).title
        return (
            f"<GearPair {self.name}: {pinion.teeth}/{gear.teeth} teeth, "
            f"module {self.basic_rack.module * 1e3:g} mm, "
            f"face widths {pinion.face_width * 1e3:g}/{gear.face_width * 1e3:g} mm, "
            f"{to_stated(operating.pinion_speed, 'rpm'):g} rpm, {operating.pinion_torque:g} N m, "
            f"friction {law}>"
        )

    __str__ = __repr__

    def _repr_html_(self) -> str:
        """Return all fields with units as a table that unfolds, for notebooks."""
        rows = "".join(
            f"<tr><td>{path}</td><td>{html.escape(str(value))}</td><td>{_unit_beside(path, value)}</td></tr>"
            for path, value in leaf_paths(self).items()
        )
        head = html.escape(repr(self)[1:-1])
        return f"<details><summary>{head}</summary><table>{rows}</table></details>"

    def to_mapping(self) -> dict[str, Any]:
        """Return the pair as nested plain data for TOML or JSON.

        These data, read again, give an equal pair.
        """
        data = super().to_mapping()
        data.pop("assumed")
        tables = {name: dict(data.pop(name, {})) for name in ("sources", "uncertainty", "posterior")}
        written = self.assumed.without(
            *self._assumed_sizes()
        )  # the assumed sizes follow from the written fields
        tables = {"sources": tables["sources"], "assumed": written.to_mapping()} | tables
        return data | {name: table for name, table in tables.items() if table}

    def to_toml(self) -> str:
        """Return the pair as TOML text. This text, read again, gives an equal pair."""
        import tomli_w

        return tomli_w.dumps({"format": FORMAT} | self.to_mapping())

    def with_(self, changes: dict[str, Any] | None = None, /, **fields: Any) -> GearPair:
        """Return a validated variation of this pair.

        Parameters
        ----------
        changes : dotted field paths -> values, e.g. ``{"operating.pinion_speed": "2000 rpm"}``
        **fields : field paths with ``__`` for the dot: ``operating__pinion_speed=2000``. A bare number is in
            the field's stated unit. Text with a unit, and a value read from a field, keep their units. A dict
            replaces a whole section; ``None`` restores the default. Short names are ``speed``,
            ``torque``, ``range``, ``law``, ``stiffness``, ``damping``, ``module``, ``pressure_angle``,
            ``viscosity``, ``oil`` ("ISO VG 220", with ``temperature``) and, of both gears, ``teeth``
            ("19/41"), ``face_width``, ``roughness``. ``gears.`` in front of a key means both gears,
            ``bearings.stiffness`` all four directions.

        ``law`` and ``stiffness`` may also be a law of the user: a function, an array or columns. Such a law
        is sampled into the table of a parameter file, after all other changes (docs/how_to/own_laws.md).

        - law as a function: magnitude of mu of any of ``xi`` (position from X [m]), ``radius`` [m],
          ``sliding_velocity``, ``entraining_velocity`` [m/s], ``slide_to_roll``, ``hertz_pressure`` [Pa],
          ``film_thickness`` [m], ``film_parameter``; called with numbers at the operating point.
        - law as an array: mu at equal distances from A to D.
        - stiffness as a text: the name of a model; as a number: the constant stiffness of the whole mesh
        [N/m]. - stiffness as a function: of ``xi``, one pair from A to D, or of ``phase`` from 0 to 1, all
          pairs over a mesh cycle that begins at A [N/m]; as an array: over phase 0 to 1, both ends included.
          A stiffness of the whole mesh is not changed: contact is prescribed, and relief is part of the
          stiffness.
        - columns: a mapping or DataFrame such as ``{"position [mm]": ..., "coefficient": ...}``,
          ``{"phase": ..., "stiffness [N/um]": ...}``.

        Raises
        ------
        ParameterError : a value that is refused, or a name that is no field; the refusal suggests the nearest
            field
        """
        request = {**(changes or {}), **{key.replace("__", "."): v for key, v in fields.items()}}
        fields = by_fields(request)
        user_laws = {path: fields.pop(path) for path in list(fields) if own_laws.is_own(path, fields[path])}
        # Contact and relief are judged together with the stiffness of the same request.
        beside = {
            path: fields.pop(path) for path in _BESIDE if path in fields and "mesh.stiffness" in user_laws
        }
        pair = self._changed(fields) if fields or not user_laws else self
        for path, value in user_laws.items():
            if path == "friction.law":
                pair = pair._changed(own_laws.own_friction(pair.nominal_contact, value))
            else:
                pair = pair._changed(own_laws.own_stiffness(pair.geometry, value) | beside)
                pair.mesh.stiffness.curve(pair)  # a table that does not fit is refused here
        return pair

    def _changed(self, fields: Mapping[str, Any]) -> GearPair:
        if (change := value_changes(self, fields)) is not None:
            # The whole check refuses in the words of all rules together.
            with suppress(ParameterError, ArithmeticError):
                return self._with_values(change)
        return validated(changed(self, fields), f"{self.name} varied")

    def _with_values(self, change: ValueChanges) -> GearPair:
        """The pair with other values in fields that it has; only rules that read these fields are checked."""
        sections = {name: getattr(self, name) for name in GearPair.model_fields}
        pair = GearPair.model_construct(**sections | change.sections | {"sources": change.sources})
        speed = pair.operating.pinion_speed
        geometry = self.geometry if speed == self.operating.pinion_speed else self.geometry.at_speed(speed)
        problems: list[FieldProblem] = []
        if pair._cut_and_placed == self._cut_and_placed and math.isfinite(geometry.mesh_period):
            shared = {name: getattr(self, name) for name in ("wheels", "profile_shifts", "tip_alteration")}
            pair.__dict__.update(shared, geometry=geometry)
        else:
            problems = pair._problems_of_existence()
        pair._parts_fit(problems)
        pair._completed()
        assumed = self.assumed.without(*change.outdated, *self._assumed_sizes())
        pair.__dict__["assumed"] = Assumed({**assumed, **pair._assumed_sizes()})
        return pair

    @property
    def _cut_and_placed(self) -> tuple[tuple[Wheel, Wheel], float | None, float]:
        """What decides the geometry beside the speed: the gears as cut, their distance, and the backlash."""
        return self.wheels, self.centre_distance, self.mesh.backlash


_VARIATION = "Make a variation: pair.with_(speed=2000). A pair does not change and needs no copy."
_FROM_DATA = "Read a mapping or a file with load_gear_pair(...)."
#: Method of the schema library that a pair has by inheritance -> what to write instead.
_OF_THE_LIBRARY = {
    **dict.fromkeys(("copy", "model_copy", "construct"), _VARIATION),
    **dict.fromkeys(("dict", "model_dump"), "Plain data: pair.to_mapping()."),
    **dict.fromkeys(("json", "model_dump_json"), "Text of a file: pair.to_toml()."),
    **dict.fromkeys(("schema", "schema_json"), "The JSON Schema: lumped.json_schema()."),
    **dict.fromkeys(("model_validate", "model_validate_json", "model_validate_strings"), _FROM_DATA),
    **dict.fromkeys(("parse_obj", "parse_raw", "parse_file", "validate", "from_orm"), _FROM_DATA),
}


def _refusing(name: str, action: str) -> Callable[..., NoReturn]:
    def method(*_: Any, **__: Any) -> NoReturn:
        raise refuse(f"pair.{name}", "a method of the schema library", "the methods of a pair", action)

    method.__name__ = name
    method.__doc__ = f"Refuse. {action}"
    return method


for _name, _action in _OF_THE_LIBRARY.items():
    setattr(GearPair, _name, _refusing(_name, _action))


def leaf_paths(pair: GearPair) -> dict[str, Any]:
    """Return dotted path -> value in file units of every set field, without the tables about fields.

    The path of an entry in a list of tables contains the number of the entry, from 0 on.
    """
    result: dict[str, Any] = {}

    def walk(data: Mapping[str, Any], prefix: str) -> None:
        for key, value in data.items():
            path = f"{prefix}{key}"
            if isinstance(value, Mapping):
                walk(value, f"{path}.")
            elif isinstance(value, list) and value and isinstance(value[0], Mapping):
                walk({str(number): entry for number, entry in enumerate(value)}, f"{path}.")
            else:
                result[path] = value

    walk({k: v for k, v in pair.to_mapping().items() if k not in ABOUT}, "")
    return result


def field_values(pair: GearPair) -> dict[str, Any]:
    """Return `leaf_paths`, and the assumed values of fields that the file does not have."""
    written = leaf_paths(pair)
    values = written | {path: value for path, value in pair.assumed.items() if path not in written}
    sections = list(dict.fromkeys(path.rpartition(".")[0] for path in written))
    return {
        path: values[path] for path in sorted(values, key=lambda one: sections.index(one.rpartition(".")[0]))
    }


def validated(data: Mapping[str, Any], source: str, folder: Path = Path()) -> GearPair:
    """Return the gear pair of plain data in file units, or refuse the data in the user's words.

    ``source`` is the origin of the data. Data files named in the data are read relative to ``folder``. Data
    of an older ``format`` keep their old meaning. Data without a format are of today's format.
    """
    fields = upgraded(data)
    return made_of(GearPair, fields, source, folder)


def field_at(path: str) -> FieldInfo:
    """Return pydantic's description of a field of a gear pair by dotted path.

    A path of no field is refused, with the nearest field.
    """
    return field_of(GearPair, path)


@lru_cache(maxsize=1024)  # every variation of a pair has the same paths
def _path_problems(path: str, table: str) -> tuple[FieldProblem, ...]:
    """Problems of a path in a table about fields. A misspelt path would leave a value without a source."""
    try:
        field_at(path)
    except ParameterError as error:
        return tuple(replace(problem, field=f"{table}.{problem.field}") for problem in error.problems)
    return ()


def stated_unit(path: str) -> str | None:
    """Return the stated unit of a field by dotted path, or None where the field has none."""
    return next((marker.unit for marker in field_at(path).metadata if isinstance(marker, Quantity)), None)


def _unit_beside(path: str, value: object) -> str:
    """Unit of a number in a parameter file; empty for a value without a unit, or with a unit in the text."""
    if isinstance(value, str) or (path.startswith("mesh.stiffness.") and isinstance(value, list)):
        return ""
    unit = stated_unit(path)
    return "" if unit in (None, "1") else str(unit).replace("**", "^").replace("*", " ")

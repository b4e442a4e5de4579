"""A friction law of the user: a table of mu over the path of contact.

Sources: monotone piecewise cubics, Fritsch and Carlson, SIAM Journal on Numerical Analysis 17 (1980) 238-246.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from functools import lru_cache
from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import Field, ValidationInfo, model_validator

from lumped.errors import FieldProblem
from lumped.fields.section import Section, Text
from lumped.fields.tables import check_points, positions, spline, uncovered, with_file
from lumped.fields.units import Quantity
from lumped.friction.base import ContactPath, FrictionLaw, FrictionSettings
from lumped.gear_geometry.geometry import Geometry
from lumped.ranges import ValidityRange
from lumped.typing import FloatArray

#: Name and unit of the column in a file.
COEFFICIENT = ("coefficient", "1")
#: Name of the law in parameter files.
TABLE = "table"
#: Share by which speed and load may differ from the table's. Published laws go with a power of at most 0.3
#: of them, so mu differs by at most 1.5 %.
_NEAR = 0.05
_MADE_AT = "the table holds at one operating point, +- 5 %"
#: A point this close to P, as a share of the table's length, is at P.
_AT_PITCH = 1e-9


class FrictionTable(Section):
    """The law 'table': friction coefficient of the user over the path of contact, at one operating point."""

    name: Text = Field(
        "table", min_length=1, max_length=60, description='its name, after "user\'s", in legends'
    )
    axis: Literal["position_mm", "roll_angle_deg"] = Field(
        "position_mm", description="what 'points' are: distance from X [mm] or pinion roll angle [deg]"
    )
    points: tuple[float, ...] = Field(
        min_length=4, max_length=10_000, description="increasing abscissae, in the unit of 'axis'"
    )
    coefficient: tuple[float, ...] = Field(
        min_length=4,
        max_length=10_000,
        description="magnitude of mu at the points [1]; the sign follows from the direction of sliding",
    )
    speed: Annotated[float | None, Quantity("rpm", above=0, optional=True)] = Field(
        None, description="pinion speed at which the table holds; default every speed"
    )
    unit_load: Annotated[float | None, Quantity("N/mm", above=0, optional=True)] = Field(
        None, description="load per face width at which the table holds; default every load"
    )

    @model_validator(mode="before")
    @classmethod
    def _read_file(cls, data: Any, info: ValidationInfo) -> Any:
        """Replace ``file = "mu.csv"`` by its contents; a relative path is beside the parameter file."""
        return with_file(data, info, COEFFICIENT)

    @model_validator(mode="after")
    def _checked(self) -> Self:
        action = "Give the magnitude; the sign follows from the direction of sliding."
        check_points(self.points, self.coefficient, COEFFICIENT, 1.0, action)
        return self

    def problems(self, g: Geometry) -> Iterator[FieldProblem]:
        """A table that does not reach from A to D."""
        x = positions(self.points, self.axis, g.base_radius_pinion)
        if problem := uncovered(x, g.L_XA, g.L_XD, "friction.table.points"):
            yield problem

    @property
    def law(self) -> FrictionLaw:
        """The table as a friction law: the same at every speed and load, with a warning away from its own."""
        return _law_of(self)

    def positions(self, path: ContactPath) -> FloatArray:
        """Its points as xi [m]."""
        return positions(self.points, self.axis, path.base_radius_pinion)

    def signed(self, xi: FloatArray, path: ContactPath, settings: FrictionSettings) -> FloatArray:
        """Interpolated magnitude with the sign of the sliding; beyond the table its end values.

        A point at P ends one curve and begins another: the magnitude of most laws has a corner there.
        """
        x = self.positions(path)
        y = np.array(self.coefficient)
        positions = np.clip(xi, *self.positions(path)[[0, -1]])
        corner = [i for i in range(1, x.size - 1) if abs(x[i] - path.L_XP) <= _AT_PITCH * (x[-1] - x[0])]
        magnitude = np.empty_like(positions)
        ends = [0, *corner, x.size - 1]
        for first, last in itertools.pairwise(ends):
            inside = (positions >= x[first]) & (positions <= x[last])
            magnitude[inside] = spline(x[first : last + 1], y[first : last + 1], "monotone")(
                positions[inside]
            )
        return np.asarray(magnitude * np.sign(xi - path.L_XP), dtype=np.float64)


@lru_cache(maxsize=64)
def _law_of(table: FrictionTable) -> FrictionLaw:
    speed = None if table.speed is None else table.speed * 30.0 / np.pi
    load = None if table.unit_load is None else table.unit_load * 1e-3
    made_at = [("pinion_speed", "rpm", speed), ("unit_load", "N/mm", load)]
    return FrictionLaw(
        name=TABLE,
        label=f"user's {table.name}",
        formula=table.signed,
        switches=lambda path, settings: [path.L_XP],
        joints=lambda path: table.positions(path).tolist(),
        ranges=tuple(
            ValidityRange(quantity, unit, value * (1.0 - _NEAR), value * (1.0 + _NEAR), _MADE_AT)
            for quantity, unit, value in made_at
            if value is not None
        ),
        reads=frozenset(),
        varies=False,
    )

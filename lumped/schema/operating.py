"""Schema of the operating point, and the speeds that charts cover."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BeforeValidator, Field
from pydantic_core import PydanticCustomError

from lumped.fields.quantity_range import QuantityRange
from lumped.fields.section import Section
from lumped.fields.units import Quantity

#: Largest speed of a pinion [rpm].
LARGEST_SPEED = 200000.0
_SPEED = Quantity(
    "rpm",
    above=0,
    at_most=LARGEST_SPEED,
    action="Give the running speed; the pinion drives in its positive sense.",
)
_BRAKE = Quantity("N*m", above=0, at_most=1e9, action="Correct the value, or write 'balanced'.")


def _brake(value: object) -> object:
    if value == "balanced":
        return value
    try:
        return _BRAKE.parse(value)
    except PydanticCustomError as error:
        context = error.context or {}
        allowed = f"{context['allowed']} or 'balanced'"
        raise PydanticCustomError(
            "quantity", "{value}: allowed {allowed}", context | {"allowed": allowed}
        ) from None


class OperatingPoint(Section):
    """Where the pair runs. The pinion drives, in its positive sense."""

    pinion_speed: Annotated[float, _SPEED] = Field(description="nominal speed of the pinion")
    pinion_torque: Annotated[float, Quantity("N*m", at_least=1e-9, at_most=1e9)] = Field(
        description="torque driving the pinion"
    )
    brake_torque: Annotated[
        Literal["balanced"] | float, BeforeValidator(_brake, json_schema_input_type=float | str)
    ] = Field(
        "balanced",
        description="torque braking the gear [N*m], or 'balanced': no drift of the mean speed",
        json_schema_extra={"unit": "N*m", "si_unit": "N*m"},
    )
    speed_range: Annotated[
        tuple[float, float] | None, QuantityRange(_SPEED, "Give two pinion speeds: 200..3000.")
    ] = Field(
        None,
        description="lowest and highest pinion speed of charts, sweeps and margins; default: from a tenth of "
        "pinion_speed to twice it",
    )

"""The operating point of a gear pair: speed, and torque or power."""

from __future__ import annotations

import math
from typing import Annotated, Any, Literal

from pydantic import ConfigDict, Field, model_validator

from lumped.errors import refuse
from lumped.fields.section import Section
from lumped.fields.units import Quantity, QuantityRange, SIValue, to_si
from lumped.schema.teeth import TorqueRipple

#: Largest speed of a pinion [rpm].
LARGEST_SPEED = 200000.0
_RUNNING = "Give the running speed; the pinion drives in its positive sense."


def _torque_or_power(schema: dict[str, Any]) -> None:
    """Require one of torque and power in the JSON Schema of a file."""
    schema["required"] = [name for name in schema["required"] if name != "pinion_torque"]
    schema["oneOf"] = [{"required": ["pinion_torque"]}, {"required": ["pinion_power"]}]


class OperatingPoint(Section):
    """Speeds and torques of the pair. The pinion drives in the positive sense.

    A file may state ``pinion_power`` in place of ``pinion_torque``. The torque is then the power over the
    speed of the file, and stays where the speed is varied. ``pinion_power`` of a pair is torque times speed.
    """

    model_config = ConfigDict(json_schema_extra=_torque_or_power)

    pinion_speed: Annotated[float, Quantity("rpm", above=0, at_most=LARGEST_SPEED, action=_RUNNING)] = Field(
        description="nominal speed of the pinion"
    )
    pinion_torque: Annotated[float, Quantity("N*m", at_least=1e-9, at_most=1e9)] = Field(
        description="torque driving the pinion"
    )
    pinion_power: Annotated[
        float | None, Quantity("kW", above=0, at_most=1e10, optional=True, action="Give the driving power.")
    ] = Field(
        None, description="driving power, in place of pinion_torque: the torque is the power over the speed"
    )
    brake_torque: Annotated[
        Literal["balanced"] | float, Quantity("N*m", above=0, at_most=1e9, word="balanced")
    ] = Field("balanced", description="torque braking the gear, or 'balanced': no drift of the mean speed")
    speed_range: Annotated[
        tuple[float, float] | None,
        QuantityRange("rpm", above=0, at_most=LARGEST_SPEED, action="Give two pinion speeds: 200..3000."),
    ] = Field(
        None,
        description="lowest and highest pinion speed of charts, sweeps and margins; default: from a tenth of "
        "pinion_speed to twice it",
    )
    torque_ripple: tuple[TorqueRipple, ...] = Field(
        (), max_length=100, description="harmonics of the torques over the turns of the shafts"
    )

    @model_validator(mode="before")
    @classmethod
    def _torque_of_power(cls, data: Any) -> Any:
        """Put the torque in place of a stated power."""
        if not isinstance(data, dict) or data.get("pinion_power") is None:
            return data
        power = data["pinion_power"]
        if data.get("pinion_torque") is not None:
            action = "Leave one of them out: the torque is the power over the speed."
            raise refuse("pinion_power", power, "without pinion_torque", action)
        torque = torque_of(power, data.get("pinion_speed"))
        # Where power or speed is refused, 1 N m lets nobody read of a torque that the file does not have.
        return data | {"pinion_torque": 1.0 if torque is None else torque}

    @model_validator(mode="after")
    def _power_of_torque(self) -> OperatingPoint:
        self.__dict__["pinion_power"] = SIValue(self.pinion_torque * self.pinion_speed, "W")
        self.model_fields_set.add("pinion_power")  # it is no assumed default
        return self

    def at_speed(self, speed: float) -> OperatingPoint:
        """The same torques at another pinion speed [rad/s], without a new check."""
        power = SIValue(self.pinion_torque * speed, "W")
        return self.model_copy(update={"pinion_speed": SIValue(speed, "rad/s"), "pinion_power": power})

    @property
    def derived_fields(self) -> tuple[str, ...]:
        """The power, which follows from torque and speed."""
        return ("pinion_power",)


def torque_of(power: object, speed: object) -> float | None:
    """Return the torque [N m] of a power and a speed as a file states them; None: one of them is refused."""
    try:
        torque = to_si(power, "kW") / to_si(speed, "rpm")  # type: ignore[arg-type]
    except (TypeError, ValueError, ArithmeticError):
        return None
    if not (torque > 0.0 and math.isfinite(torque)):
        return None
    return float(
        f"{torque:.15g}"
    )  # the power that a pair reads as gives the torque back, 56.5 and not 56.4...9

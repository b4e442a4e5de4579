"""What turns the pinion and brakes the gear: torque histories, a motor behind a spring, run-up ramps.

Sources: docs/theory/multibody.md, "Time integration".
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from lumped.arguments import real_number, real_numbers
from lumped.errors import refuse
from lumped.typing import FloatArray
from multibody.contact.compiled import compiled

_RPM = np.pi / 30.0


@dataclass(frozen=True)
class Drive:
    """Drive and load of a multibody run. Without one, both torques are constant and balanced.

    A history is a pair (times [s], values): linear between its points, constant before and after.

    Attributes
    ----------
    stiffness : of a torsional spring between motor and pinion [N m/rad]; with 0 there is no motor. The motor
        turns at a prescribed speed and holds the mean speed of the pair; the spring is unloaded at the pair's
        driving torque, which keeps acting
    damping : of that spring [N m s/rad]
    motor_speed : history of the motor speed [rpm]; None is the pair's pinion speed
    pinion_torque : history of the driving torque [N m]; None is the pair's
    brake_torque : history of the braking torque on the gear [N m]; None is the pair's, balanced if it says so
    """

    stiffness: float = 0.0
    damping: float = 0.0
    motor_speed: tuple[ArrayLike, ArrayLike] | None = None
    pinion_torque: tuple[ArrayLike, ArrayLike] | None = None
    brake_torque: tuple[ArrayLike, ArrayLike] | None = None


@dataclass(frozen=True, eq=False)
class DriveTables:
    """A drive as arrays for the compiled core: what it adds to constant torques and nominal speed.

    Attributes
    ----------
    spring : (3,) stiffness, damping, initial angle of the motor beyond nominal [N m/rad], [N m s/rad], [rad]
    motor : (n, 2) rows of time, speed beyond nominal [s], [rad/s]
    pinion, gear : (n, 2) rows of time, torque beyond the constant one [s], [N m]
    """

    spring: FloatArray
    motor: FloatArray
    pinion: FloatArray
    gear: FloatArray


def drive_tables(
    drive: Drive, omega: float, torque_pinion: float, torque_gear: float, angle: float
) -> DriveTables:
    """Check a drive and turn it into arrays.

    Parameters
    ----------
    drive : what the user asked for
    omega : nominal pinion speed [rad/s]
    torque_pinion, torque_gear : constant torques that act anyway [N m]
    angle : initial deviation of the pinion from nominal rotation, where the motor starts too [rad]

    Raises
    ------
    ParameterError : a negative spring, a ramp without a spring, or a history that is none
    """
    for name in ("stiffness", "damping"):
        real_number(f"drive.{name}", getattr(drive, name), 0.0)
    if drive.motor_speed is not None and drive.stiffness == 0.0:
        raise refuse(
            "drive.stiffness", 0.0, "> 0 N m/rad with a motor speed", "Couple the motor by a spring."
        )
    motor = _history("motor_speed", drive.motor_speed, omega / _RPM)
    pinion = _history("pinion_torque", drive.pinion_torque, torque_pinion)
    gear = _history("brake_torque", drive.brake_torque, torque_gear)
    return DriveTables(
        spring=np.array([drive.stiffness, drive.damping, angle]),
        motor=np.column_stack([motor[:, 0], motor[:, 1] * _RPM - omega]),
        pinion=pinion - [0.0, torque_pinion],
        gear=gear - [0.0, torque_gear],
    )


def _history(name: str, history: tuple[ArrayLike, ArrayLike] | None, default: float) -> FloatArray:
    if history is None:
        return np.array([[0.0, default]])
    try:
        given, wanted = history
    except (TypeError, ValueError):
        given = wanted = ()
    times = real_numbers(f"drive.{name} times", given, 0.0, increasing=True, unit="s")
    values = real_numbers(f"drive.{name} values", wanted)
    if times[0] != 0.0 or times.size != values.size:
        raise refuse(
            f"drive.{name}",
            f"{times.size} times from {times[0]:g} s, {values.size} values",
            "(times, values) of equal length, from 0 s",
            "Sort the times and start at 0.",
        )
    return np.column_stack([times, values])


@compiled
def value_and_integral(table: FloatArray, t: float) -> tuple[float, float]:
    """Value of a history (n, 2) at t and its integral from the first row on; constant outside."""
    last = table.shape[0] - 1
    if t <= table[0, 0]:
        return table[0, 1], table[0, 1] * (t - table[0, 0])
    row, integral = 0, 0.0
    while row < last and t >= table[row + 1, 0]:
        integral += 0.5 * (table[row, 1] + table[row + 1, 1]) * (table[row + 1, 0] - table[row, 0])
        row += 1
    step = t - table[row, 0]
    value = table[row, 1]
    if row < last:
        value += (table[row + 1, 1] - table[row, 1]) * step / (table[row + 1, 0] - table[row, 0])
    return value, integral + 0.5 * (table[row, 1] + value) * step


@compiled
def drive_torques(
    t: float,
    angle: float,
    speed: float,
    spring: FloatArray,
    motor: FloatArray,
    pinion: FloatArray,
    gear: FloatArray,
) -> tuple[float, float]:
    """Torques beyond the constant ones: driving the pinion, braking the gear [N m].

    Parameters
    ----------
    t : time [s]
    angle, speed : the pinion's deviations from nominal rotation, in its running sense [rad], [rad/s]
    spring, motor, pinion, gear : see ``DriveTables``
    """
    driving = value_and_integral(pinion, t)[0]
    if spring[0] > 0.0:
        motor_speed, motor_angle = value_and_integral(motor, t)
        driving += spring[0] * (spring[2] + motor_angle - angle) + spring[1] * (motor_speed - speed)
    return driving, value_and_integral(gear, t)[0]

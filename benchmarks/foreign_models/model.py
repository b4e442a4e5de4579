"""Equations of motion of the user: two torsional degrees of freedom, or six with four bearings.

Every term has its sign and its factor as a number of its own, so that a user may get one of them wrong.
Source: He, Cho and Singh, J. Sound Vib. 309 (2008) 843-851, equations (1) to (9) as docs/theory/equations.md.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from benchmarks.foreign_models.drawing import Drawing, Line, Wheel, line_of_action
from benchmarks.foreign_models.laws import Law, friction_law, stiffness_law

#: Entries of a mesh cycle in the tables of the coefficients.
TABLE = 16384

#: Numbers of the equations: the period, torques, bodies, bearings, signs of terms, forces that do not vary.
FIELDS = (
    *("period", "phase", "torque_p", "torque_g", "base_p", "base_g"),
    *("inertia_p", "inertia_g", "mass_p", "mass_g"),
    *("stiffness_xp", "stiffness_xg", "stiffness_yp", "stiffness_yg"),
    *("damping_xp", "damping_xg", "damping_yp", "damping_yg"),
    *("unilateral", "rigid", "moment_sign_p", "moment_sign_g"),
    *("force_sign_xp", "force_sign_xg", "force_sign_yp", "force_sign_yg"),
    *("load_xp", "load_xg", "load_yp", "load_yg"),
    *("drive_stiffness", "ripple", "ripple_order", "x_in_approach", "hardening", "reference_compression"),
    "static_load",
)
NUMBERS = np.dtype([(name, "f8") for name in FIELDS])
ENTRY = np.dtype(
    [
        (name, "f8")
        for name in ["stiffness", "damping", "mu", "share", "error", "error_rate", "arm_p", "arm_g"]
    ]
)

#: Order of the displacements in a state; their rates follow in the same order.
DISPLACEMENTS = ("theta_p", "theta_g", "x_p", "x_g", "y_p", "y_g")
STATES = 2 * len(DISPLACEMENTS)


def no_error(xi: np.ndarray) -> np.ndarray:
    return np.zeros_like(xi)


@dataclass(frozen=True)
class Model:
    """What the user's program integrates. Signs are factors of terms, 1 where the term is right."""

    line: Line
    drawing: Drawing
    inertia_p: float
    inertia_g: float
    mass_p: float
    mass_g: float
    stiffness: Law
    friction: Law
    damping: Callable[[Model, np.ndarray], np.ndarray]
    speed: float
    torque: float
    unilateral: bool = False
    torsional: bool = False
    error: Law = no_error
    bearing_stiffness: dict[str, float] = field(default_factory=dict)
    bearing_damping: dict[str, float] = field(default_factory=dict)
    signs: dict[str, float] = field(default_factory=dict)
    others: dict[str, float] = field(default_factory=dict)
    arm_p: Callable[[Model, np.ndarray], np.ndarray] = lambda model, xi: xi
    arm_g: Callable[[Model, np.ndarray], np.ndarray] = lambda model, xi: model.line.length - xi
    total: Callable[[np.ndarray, np.ndarray], np.ndarray] | None = None
    table: int = TABLE
    period_factor: float = 1.0
    balanced: bool = True

    def but(self, **changes: object) -> Model:
        """Return the model with other fields."""
        return replace(self, **changes)  # type: ignore[arg-type]

    @property
    def period(self) -> float:
        """Duration of a mesh cycle [s]."""
        return self.period_factor * self.line.base_pitch / (self.speed * self.line.base_radius_p)

    @property
    def effective_mass(self) -> float:
        """Mass of both gears on the line of action [kg]."""
        line = self.line
        return 1.0 / (line.base_radius_p**2 / self.inertia_p + line.base_radius_g**2 / self.inertia_g)


def disc(wheel: Wheel, module: float) -> tuple[float, float]:
    """Mass and polar moment of inertia of a disc of the reference diameter."""
    outer, inner = 0.5 * module * wheel.teeth, 0.5 * wheel.bore
    mass = wheel.density * math.pi * (outer**2 - inner**2) * wheel.width
    inertia = 0.5 * mass * (outer**2 + inner**2)
    return wheel.mass or mass, wheel.inertia or inertia


def ratio_damping(model: Model, xi: np.ndarray) -> np.ndarray:
    """Damping of a tooth pair, 2 zeta sqrt(k m_e)."""
    return 2.0 * model.drawing.mesh_damping * np.sqrt(model.stiffness(xi) * model.effective_mass)


def model_of(
    drawing: Drawing, unilateral: bool = False, torsional: bool = False, line: Line | None = None
) -> Model:
    """Build the user's model from the numbers of the drawing; ``line`` by default that of the drawing."""
    line = line_of_action(drawing) if line is None else line
    mass_p, inertia_p = disc(drawing.pinion, drawing.module)
    mass_g, inertia_g = disc(drawing.gear, drawing.module)
    stiffness: dict[str, float] = {}
    damping: dict[str, float] = {}
    for end, wheel, mass in (("p", drawing.pinion, mass_p), ("g", drawing.gear, mass_g)):
        stiffness |= {f"x{end}": wheel.loa_stiffness, f"y{end}": wheel.oloa_stiffness}
        damping |= {
            f"x{end}": 2.0 * wheel.loa_damping * math.sqrt(wheel.loa_stiffness * mass),
            f"y{end}": 2.0 * wheel.oloa_damping * math.sqrt(wheel.oloa_stiffness * mass),
        }
    return Model(
        line=line,
        drawing=drawing,
        inertia_p=inertia_p,
        inertia_g=inertia_g,
        mass_p=mass_p,
        mass_g=mass_g,
        stiffness=stiffness_law(drawing, line),
        friction=friction_law(drawing, line),
        damping=ratio_damping,
        speed=drawing.speed,
        torque=drawing.torque,
        unilateral=unilateral,
        torsional=torsional,
        bearing_stiffness=stiffness,
        bearing_damping=damping,
    )


def numbers_of(model: Model, torque_g: float) -> np.void:
    """Return the constants of the equations, by name."""
    line = model.line
    numbers = np.zeros(1, NUMBERS)[0]
    values: dict[str, float] = {
        "period": model.period,
        "torque_p": model.torque,
        "torque_g": torque_g,
        "base_p": line.base_radius_p,
        "base_g": line.base_radius_g,
        "inertia_p": model.inertia_p,
        "inertia_g": model.inertia_g,
        "mass_p": model.mass_p,
        "mass_g": model.mass_g,
        "unilateral": float(model.unilateral),
        "rigid": float(model.torsional),
        "x_in_approach": 1.0,
    }
    values |= {f"stiffness_{where}": value for where, value in model.bearing_stiffness.items()}
    values |= {f"damping_{where}": value for where, value in model.bearing_damping.items()}
    values |= {name: 1.0 for name in FIELDS if "_sign_" in name}
    values |= {name: model.signs[name] for name in model.signs} | model.others
    for name, value in values.items():
        numbers[name] = value
    return numbers


def table_of(model: Model) -> np.ndarray:
    """Coefficients of the tooth pairs over a mesh cycle, of shape (pairs, entries)."""
    line = model.line
    last = math.floor(line.contact_ratio)
    phase = (np.arange(model.table) + 0.5) / model.table
    table = np.zeros((last + 1, model.table), ENTRY)
    for index in range(last + 1):
        xi = line.start + (last - index + phase) * line.base_pitch
        on = (xi >= line.start) & (xi <= line.end)
        row = table[index]
        row["stiffness"] = np.where(on, model.stiffness(xi), 0.0)
        row["damping"] = np.where(on, model.damping(model, xi), 0.0)
        row["mu"] = np.where(on, model.friction(xi), 0.0)
        row["error"] = np.where(on, model.error(xi), 0.0)
        step = line.base_pitch / model.table
        slope = (model.error(xi + 0.5 * step) - model.error(xi - 0.5 * step)) / step
        row["error_rate"] = np.where(on, slope * line.base_pitch / model.period, 0.0)
        row["arm_p"] = model.arm_p(model, xi)
        row["arm_g"] = model.arm_g(model, xi)
    table["share"] = table["stiffness"] / np.maximum(table["stiffness"].sum(axis=0), 1e-300)
    if model.total is not None:
        table["stiffness"] *= model.total(phase, table["stiffness"].sum(axis=0))
    return table

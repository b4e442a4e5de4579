"""The time-averaged gear pair as a state space of python-control; its modes and their damping."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from lumped.arguments import one_of
from lumped.errors import NumericalError
from lumped.labelling import provenance
from lumped.model.equations import X_G, X_P
from lumped.model.periodic_system import LTVSystem, Supports, on_springs, supports_of
from lumped.model.supports import Form
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray

if TYPE_CHECKING:
    import control
    import xarray as xr

#: Gauss-Legendre rule per polynomial piece of the average, exact to degree 47.
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(24)


def averaged_matrix(system: LTVSystem) -> FloatArray:
    """Mean of A(t) over one mesh cycle, integrated piece by piece."""
    total = np.zeros((system.size, system.size))
    for low, high in itertools.pairwise(system.cycle.breaks):
        nodes = 0.5 * (low + high) + 0.5 * (high - low) * _NODES
        total += 0.5 * (high - low) * np.tensordot(_WEIGHTS, system.matrices(nodes), axes=1)
    return total / system.period


def averaged_state_space(
    pair: AnyPair, form: Form = "elastic", *, supports: Supports | None = None
) -> control.StateSpace:
    """Time-averaged linear model on springs from the torques T_p, T_g to the transmission error, x_p and x_g.

    Parameters
    ----------
    pair : gear pair, preset name or parameter file
    form : "elastic" (10 states) or "mesh" (6 states); the rigid rotation is left out
    supports : "springs"; a pair with shafts must ask for springs

    Returns
    -------
    control.StateSpace with named inputs [N m], outputs [m] and states

    Raises
    ------
    ParameterError : form "full", whose rigid rotation has no frequency response at rest, or shafts

    Sources: docs/theory/equations.md, the state matrix averaged over one mesh cycle.
    """
    import control  # takes longer to import than all else of lumped; modes do without

    pair = on_springs(load_gear_pair(pair), supports, "averaged_state_space")
    one_of("form", form, ("elastic", "mesh"), "The rigid rotation has no steady response.")
    system = LTVSystem.of(pair, form, supports="springs")
    m = len(system.coordinates)
    b = np.stack([system.torque_pinion, system.torque_gear], axis=1)
    c = np.zeros((3, system.size))
    c[0, :m] = system.deflection
    c[1, X_P - 1] = 1.0  # without the common rotation: one coordinate less
    c[2, X_G - 1] = 1.0
    return control.ss(
        averaged_matrix(system),
        b,
        c,
        np.zeros((3, 2)),
        inputs=["torque_pinion", "torque_gear"],
        outputs=["dte", "x_p", "x_g"],
        states=list(system.state_names),
        name=pair.name.replace(".", "_"),  # python-control refuses a dot
    )


@dataclass(frozen=True)
class Mode:
    """One mode of the averaged system.

    Attributes
    ----------
    natural_frequency : undamped [Hz]
    damping_ratio : [-]
    resonant_speed : pinion speed at which the mesh frequency is the natural frequency [rpm]
    shape : real amplitude of each coordinate over the largest amplitude. The coordinates are q, x_p, x_g,
        y_p, y_g; on shafts, the modes of the shafts with the teeth apart
    """

    natural_frequency: float
    damping_ratio: float
    resonant_speed: float
    shape: dict[str, float]


def natural_frequencies(pair: AnyPair, *, supports: Supports | None = None) -> xr.DataArray:
    """Return the natural frequencies of the pair with its mean mesh stiffness, increasing [Hz].

    Parameters
    ----------
    pair : gear pair, preset name or parameter file
    supports : "springs" or "shafts", as of ``periodic_system``; by default the shafts of a pair that has them

    Returns
    -------
    xarray.DataArray over ``mode``, counted from 1, with the coordinates ``damping_ratio``,
    ``resonant_speed_rpm`` (pinion speed at which the mesh frequency is the natural frequency) and
    ``coordinate`` (the one that moves most)

    Raises
    ------
    ParameterError : a refused parameter, or shafts that the pair does not have
    NumericalError : a mode is overdamped, so it has no natural frequency

    Sources: docs/theory/equations.md, the state matrix averaged over one mesh cycle.
    """
    import xarray as xr  # takes a third of a second, which an import of the package should not

    pair = load_gear_pair(pair)
    chosen = supports_of(pair, supports)
    computed = modes(pair, chosen)
    of_modes = {
        "mode": ("mode", np.arange(1, len(computed) + 1), {"units": "1", "long_name": "mode"}),
        "damping_ratio": (
            "mode",
            np.array([mode.damping_ratio for mode in computed]),
            {"units": "1", "long_name": "damping ratio"},
        ),
        "resonant_speed_rpm": (
            "mode",
            np.array([mode.resonant_speed for mode in computed]),
            {
                "units": "rpm",
                "long_name": "pinion speed at which the mesh frequency is the natural frequency",
            },
        ),
        "coordinate": (
            "mode",
            np.array([_largest(mode) for mode in computed], dtype=object),
            {"units": "1", "long_name": "coordinate that moves most"},
        ),
    }
    return xr.DataArray(
        np.array([mode.natural_frequency for mode in computed]),
        dims="mode",
        coords=of_modes,
        name="natural_frequency",
        attrs={"units": "Hz", "long_name": "natural frequency"} | provenance(pair) | {"supports": chosen},
    )


def _largest(mode: Mode) -> str:
    """Coordinate that moves most in a mode."""
    return max(mode.shape, key=lambda name: abs(mode.shape[name]))


def modes(pair: GearPair, supports: Supports = "springs") -> tuple[Mode, ...]:
    """Natural frequencies, damping and shapes of the averaged pair, by increasing frequency."""
    system = LTVSystem.of(pair, "elastic", supports=supports)
    m = len(system.coordinates)
    values, vectors = np.linalg.eig(averaged_matrix(system))
    results = []
    for value, vector in zip(values, vectors.T, strict=True):
        if value.imag <= 0.0:
            continue
        shape = vector[:m] / vector[:m][np.argmax(np.abs(vector[:m]))]
        frequency = float(abs(value)) / (2.0 * np.pi)
        results.append(
            Mode(
                natural_frequency=frequency,
                damping_ratio=float(-value.real / abs(value)),
                resonant_speed=60.0 * frequency / pair.pinion.teeth,
                shape={name: float(a.real) for name, a in zip(system.coordinates, shape, strict=True)},
            )
        )
    if len(results) != m:
        raise NumericalError("A mode of the averaged pair is overdamped: lower the damping ratios.")
    return tuple(sorted(results, key=lambda mode: mode.natural_frequency))

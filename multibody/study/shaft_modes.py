"""Natural modes of a pair on its shafts with frozen mesh, by exudyn's own linearisation of the machine.

Sources: docs/theory/shafts.md, "The machine"; sense of whirl, G. Genta, Dynamics of Rotating Systems (2005).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from lumped.arguments import real_number
from lumped.errors import NumericalError
from lumped.labelling import labelled_dataset
from lumped.model.results import provenance
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.typing import ComplexArray, FloatArray
from multibody.run.setup import prepare
from multibody.shafts.shaft import columns_of
from multibody.shafts.train import Train
from multibody.study.frozen_modes import held, linearised

if TYPE_CHECKING:
    import xarray as xr

#: Parts of the machine between which a mode shares its kinetic energy.
PARTS = ("pinion shaft loa", "pinion shaft oloa", "gear shaft loa", "gear shaft oloa", "twist")
#: Places along each shaft, as shares of its length.
_PLACES = np.linspace(0.0, 1.0, 81)


def shaft_modes(pair: AnyPair, phase: float = 0.3) -> xr.Dataset:
    """Modes of the machine with the mesh frozen at a phase and the gyroscopic moments of the operating speed.

    Parameters
    ----------
    pair : a validated gear pair with shafts
    phase : of the mesh cycle, 0 to 1 without the ends; pair n is at A at 0

    Returns
    -------
    xarray.Dataset over ``mode`` by increasing frequency, the free turn left out: ``natural_frequency`` [Hz],
    ``damping_ratio`` [-], ``kinetic_share`` over (part, mode) [-], and ``whirl`` over (shaft, mode): what of
    the lateral motion of a mode whirls forward, in the sense of rotation, less what whirls backward [-]; and
    ``shape`` over (shaft, direction, place, mode): the axes when they stand furthest out, which is 1 [-].
    Roots without oscillation are left out

    Raises
    ------
    ParameterError : the phase is out of range, or the pair has no shafts
    NumericalError : exudyn finds no eigenvalues
    """
    pair = load_gear_pair(pair)
    phase = real_number("phase", phase, 1e-9, 1.0 - 1e-9)
    setup = prepare(pair, "linear", supports="shafts")
    train = setup.machine.train
    assert train is not None
    model = held(setup, phase * setup.machine.period)
    roots, vectors = linearised(model, np.zeros(train.size))
    elastic = np.argsort(np.abs(roots))[2:]
    upper = elastic[roots[elastic].imag > 0.0]
    roots, shapes = roots[upper], vectors[: train.size, upper]
    if not np.isfinite(shapes).all() or not roots.size:
        raise NumericalError("exudyn finds no modes of this machine; look for extremes of stiffness.")
    axes = np.array(
        [
            shaft.reading(_PLACES * sum(part.length for part in shaft.intervals)) @ shapes[own]
            for shaft, own in zip(train.shafts, train.places, strict=True)
        ]
    )
    return labelled_dataset(
        {
            "natural_frequency": ("mode", np.abs(roots) / (2.0 * np.pi), "Hz", "undamped natural frequency"),
            "damping_ratio": ("mode", -roots.real / np.abs(roots), "1", "damping ratio"),
            "kinetic_share": (("part", "mode"), _shares(train, shapes), "1", "share of the kinetic energy"),
            "whirl": (("shaft", "mode"), _whirl(axes), "1", "forward less backward whirl"),
            "shape": (
                ("shaft", "direction", "place", "mode"),
                _standing(axes),
                "1",
                "deflection of the axis",
            ),
        },
        {
            "mode": (np.arange(1, roots.size + 1), "1", "mode by increasing frequency"),
            "part": (list(PARTS), "1", "part of the machine"),
            "shaft": (["pinion", "gear"], "1", "shaft"),
            "direction": (["loa", "oloa"], "1", "along and off the line of action"),
            "place": (_PLACES, "1", "place along the shaft over its length"),
        },
        provenance(pair, phase=phase, supports="shafts"),
    )


def _shares(train: Train, shapes: ComplexArray) -> FloatArray:
    """Kinetic energy of each part over that of all, (5, m)."""
    found = []
    for shaft, own in zip(train.shafts, train.places, strict=True):
        for columns in columns_of(shaft.fields):
            moving = shapes[own[columns]]
            mass = shaft.mass[np.ix_(columns, columns)]
            found.append(np.einsum("im,ij,jm->m", moving.conj(), mass, moving).real)
    parts = np.array([found[0], found[1], found[3], found[4], found[2] + found[5]])
    return np.asarray(parts / parts.sum(axis=0))


def _whirl(axes: ComplexArray) -> FloatArray:
    """Forward less backward whirl over the lateral motion of both axes, (2, m), of axes (2, 2, k, m)."""
    x, y = axes[:, 0], axes[:, 1]
    # x + i y turns counter-clockwise with amplitude |X + i Y|/2 and clockwise with |X - i Y|/2.
    left, right = np.abs(x + 1j * y) ** 2, np.abs(x - 1j * y) ** 2
    forward = np.array([[-1.0], [1.0]]) * (left - right).sum(axis=1)  # the pinion turns clockwise
    lateral = (left + right).sum(axis=(0, 1))
    return np.asarray(forward / np.where(lateral > 0.0, lateral, 1.0))


def _standing(axes: ComplexArray) -> FloatArray:
    """Real shapes (2, 2, k, m): each mode when the place and direction that move most stand furthest out."""
    flat = axes.reshape(-1, axes.shape[-1])
    largest = flat[np.abs(flat).argmax(axis=0), np.arange(flat.shape[1])]
    return np.asarray((axes / np.where(largest == 0.0, 1.0, largest)).real)

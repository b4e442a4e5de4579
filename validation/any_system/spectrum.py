"""Multipliers, exponents and frequencies of a periodic system as one labelled dataset.

Sources: docs/theory/floquet.md.
"""

from __future__ import annotations

import numpy as np
import xarray as xr

from floquet import Spectrum
from lumped.labelling import labelled_dataset


def spectrum_dataset(spectrum: Spectrum) -> xr.Dataset:
    """Return the multipliers of a system, largest modulus first, with what follows from each.

    The frequency of an exponent is known up to whole multiples of 1/T; the dataset has the lowest one, 0 to
    1/(2 T). Attributes: ``period`` [s], ``verdict``, ``verdict_words``, ``certificate``, ``spectral_radius``,
    ``error``.

    Returns
    -------
    xarray.Dataset over "number": ``multipliers``, ``modulus``, ``phase`` [deg], ``bound``,
    ``growth_rate`` [1/s], ``frequency`` [Hz]
    """
    values = spectrum.multipliers
    exponents = spectrum.exponents
    dims = ("number",)
    result = labelled_dataset(
        {
            "multipliers": (dims, values, "1", "Floquet multipliers"),
            "modulus": (dims, np.abs(values), "1", "modulus of the multiplier"),
            "phase": (dims, np.degrees(np.angle(values)), "deg", "phase of the multiplier"),
            "bound": (dims, spectrum.multiplier_errors, "1", "bound on the error of the multiplier"),
            "growth_rate": (dims, exponents.real, "1/s", "growth rate, real part of the exponent"),
            "frequency": (
                dims,
                np.abs(exponents.imag) / (2.0 * np.pi),
                "Hz",
                "frequency, imaginary part of the exponent, up to multiples of 1/T",
            ),
        },
        {"number": (np.arange(1, values.size + 1), "1", "number of the multiplier")},
    )
    result.attrs.update(
        period=spectrum.period,
        verdict=spectrum.verdict,
        verdict_words=spectrum.verdict_words,
        certificate=spectrum.certificate,
        spectral_radius=spectrum.spectral_radius,
        error=spectrum.error,
    )
    return result

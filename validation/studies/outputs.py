"""What can be kept of a case, by analysis: name -> (unit, plain name)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

Analysis = Literal["geometry", "lumped", "multibody", "floquet"]
Labels = Mapping[str, tuple[str, str]]

_MOTIONS = {
    "dte": "transmission error",
    "x_p": "pinion displacement along the line of action",
    "x_g": "gear displacement along the line of action",
    "y_p": "pinion displacement off the line of action",
    "y_g": "gear displacement off the line of action",
}
_MOTION: Labels = {
    f"{name}_{kind}": ("m", f"{text}, {words}")
    for name, text in _MOTIONS.items()
    for kind, words in (("peak_to_peak", "peak to peak"), ("rms", "root mean square about its mean"))
} | {
    "normal_load_max": ("N", "largest normal load of a tooth pair in contact"),
    "normal_load_min": ("N", "smallest normal load of a tooth pair in contact; negative: the teeth separate"),
    "friction_force_peak_to_peak": ("N", "friction force of all tooth pairs, peak to peak"),
    "friction_power_mean": ("W", "mean friction power of all tooth pairs"),
}

#: Outputs of every analysis; they are all plain numbers.
OUTPUTS: Mapping[Analysis, Labels] = {
    "geometry": {
        "contact_ratio": ("1", "contact ratio"),
        "mesh_frequency": ("Hz", "mesh frequency"),
        "pitch_line_velocity": ("m/s", "pitch line velocity"),
        "operating_pressure_angle": ("rad", "operating pressure angle"),
        "centre_distance": ("m", "centre distance"),
        "normal_backlash": ("m", "normal backlash"),
        "base_pitch": ("m", "base pitch"),
        "L_XA": ("m", "distance from X to the start of contact"),
        "L_XD": ("m", "distance from X to the end of contact"),
        "L_XY": ("m", "length of the line of action between the base circles"),
    },
    "lumped": {
        **_MOTION,
        "mesh_efficiency": ("1", "mesh efficiency"),
        "brake_torque": ("N*m", "brake torque that holds the mean speed"),
        "error_estimate": ("1", "estimate of the largest relative error of the transmission error"),
    },
    "multibody": _MOTION,
    "floquet": {
        "spectral_radius": ("1", "largest modulus of the multipliers"),
        "spectral_radius_error": ("1", "bound on the error of the largest modulus"),
        "verdict": ("1", "1 stable, 0 undecided within the error, -1 unstable"),
        "liouville_residual": ("1", "mismatch of the determinant with Liouville's formula"),
    },
}

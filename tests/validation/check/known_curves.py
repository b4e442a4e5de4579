"""One motion whose every value is known by formula, for pairs with different numbers of teeth."""

import numpy as np

from lumped import load_gear_pair
from tests.unlike_pairs import unlike_pair

PAIR = load_gear_pair("nasa_art_25_31")
OTHER = unlike_pair("contact_ratio_1_1_large_shifts")
SAMPLES = 32
CYCLES = 5


class Known:
    """Motion of a pair at places over five mesh cycles, in SI."""

    def __init__(self, pair=PAIR):
        self.pair = pair
        self.s = np.arange(CYCLES * SAMPLES + 1) / SAMPLES
        self.time = self.s * pair.geometry.mesh_period
        waves = {
            "dte": (18e-6, 2e-6, 0.4), "x_p": (-9e-6, 1e-6, 1.0), "x_g": (8e-6, 0.7e-6, 2.0),
            "y_p": (1e-7, 3e-8, 0.2), "y_g": (-2e-7, 5e-8, 2.2),
            "theta_p": (3e-4, 4e-5, 0.7), "theta_g": (-2e-4, 3e-5, 1.7), "mesh_force": (1500.0, 300.0, 0.1),
            "bearing_force_x_p": (1480.0, 90.0, 0.3), "bearing_force_y_p": (12.0, 7.0, 0.5),
            "bearing_force_x_g": (-1470.0, 80.0, 0.6), "friction": (20.0, 30.0, 1.1),
            "x_p_ddot": (0.0, 120.0, 0.9), "x_p_dot": (0.0, 0.02, 0.8), "dte_dot": (0.0, 0.03, 1.9),
            "theta_p_ddot": (0.0, 900.0, 1.4),
            "mesh_stiffness": (4e8, 1e8, 0.0),
        }  # fmt: skip
        for name, (mean, amplitude, phase) in waves.items():
            second = 0.25 * amplitude * np.cos(4.0 * np.pi * self.s - phase)
            setattr(self, name, mean + amplitude * np.cos(2.0 * np.pi * self.s + phase) + second)
        self.waves = waves
        teeth = pair.pinion.teeth, pair.gear.teeth
        self.turn_p = 2.0 * np.pi * self.s / teeth[0]
        self.turn_g = 2.0 * np.pi * self.s / teeth[1]
        self.speeds = np.array([80.0, 120.0, 210.0, 333.0])
        self.peak_to_peak = np.array([3e-6, 4e-6, 9e-6, 5e-6])
        self.rms = np.array([1.0e-6, 1.4e-6, 3.1e-6, 1.8e-6])
        self.first = np.array([1.2e-6, 1.9e-6, 4.2e-6, 2.2e-6])


def rows(*columns, delimiter=",", number="{:.9e}", decimal="."):
    """Lines of numbers as a program writes them."""
    lines = (delimiter.join(number.format(value) for value in row) for row in zip(*columns, strict=True))
    return "\n".join(lines).replace(".", decimal)

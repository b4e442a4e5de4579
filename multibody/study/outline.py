"""Outlines of the two gears from the same flank angles and tip circles as the contact model."""

from __future__ import annotations

import math

import numpy as np

from lumped.schema.pair import GearPair
from lumped.typing import FloatArray
from multibody.contact import kernels as kn
from multibody.contact.kinematics import COAST, DRIVE
from multibody.contact.machine import machine


def flank_points(radius: float, chi: float, flank: float, rho: FloatArray) -> FloatArray:
    """Points of an involute in its body's frame, (k, 2) [m].

    Parameters
    ----------
    radius : base radius [m]
    chi : angle of the flank's constant [rad]
    flank : +1 drive, -1 coast
    rho : (k,) string lengths from the base circle [m]
    """
    angle = chi + flank * rho / radius
    e = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    n = flank * np.stack([-e[:, 1], e[:, 0]], axis=1)
    return np.asarray(radius * n + rho[:, None] * e, dtype=np.float64)


def flank_angles(p: FloatArray, flank: float) -> tuple[float, float]:
    """Angles chi of one side of pinion and gear [rad], from the parameters of the contact core."""
    chi, apart = (p[kn.CHI_P], p[kn.APART]) if flank > 0.0 else (p[kn.CHI_P_BACK], p[kn.APART_BACK])
    arc = flank * (p[kn.L_XY] + apart) + p[kn.RADIUS_P] * chi
    return float(chi), float(math.pi - arc / p[kn.RADIUS_G])


def gear_outline(pair: GearPair, which: str, points: int = 16) -> FloatArray:
    """Closed outline of one gear in its body's frame, counter-clockwise, (k, 2) [m].

    Involutes from the form to the tip circle, arcs along tip and root circle; the fillet is drawn as a
    straight line from the form circle to the root circle.

    Parameters
    ----------
    pair : a validated gear pair
    which : "pinion" or "gear"
    points : points per flank
    """
    g = pair.geometry
    p = machine(pair).parameters
    pinion = which == "pinion"
    radius = float(p[kn.RADIUS_P if pinion else kn.RADIUS_G])
    drive, coast = (flank_angles(p, flank)[0 if pinion else 1] for flank in (DRIVE, COAST))
    teeth = pair.pinion.teeth if pinion else pair.gear.teeth
    tip, root = (getattr(g, f"{end}_radius_{which}") for end in ("tip", "root"))
    form = max(getattr(g, f"form_radius_{which}"), radius)
    rho = np.linspace(math.sqrt(form**2 - radius**2), math.sqrt(tip**2 - radius**2), points)
    rising = flank_points(radius, drive, DRIVE, rho)
    falling = flank_points(radius, coast, COAST, rho)[::-1]
    pitch = 2.0 * math.pi / teeth
    start, top, next_top, end = (
        math.atan2(point[1], point[0]) for point in (rising[0], rising[-1], falling[0], falling[-1])
    )
    tooth = np.vstack(
        [
            rising,
            _arc(tip, top, top + (next_top - top) % (2 * math.pi)),
            falling,
            _arc(root, end, end + (start + pitch - end) % (2 * math.pi)),
        ]
    )
    turns = pitch * np.arange(teeth)
    c, s = np.cos(turns), np.sin(turns)
    rotation = np.stack([np.stack([c, -s], axis=1), np.stack([s, c], axis=1)], axis=1)
    return np.asarray(np.einsum("tij,kj->tki", rotation, tooth).reshape(-1, 2), dtype=np.float64)


def _arc(radius: float, start: float, end: float) -> FloatArray:
    angle = np.linspace(start, end, 6)
    return radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)

"""A rig by computation, whose truth is known: a pair with few uncertain inputs, and records of its motion."""

import numpy as np

import spurcheck
from validation.check.curves import Channel, Curves
from validation.check.motion_curves import MotionCurves
from validation.prediction.motion import predicted

RANGES = {
    "mesh.stiffness_factor": "+- 10 %",
    "mesh.damping_ratio": "/ 2.5 .. * 2.5",
    "bearings.gear.loa_stiffness": "/ 2 .. * 2",
    "bearings.pinion.oloa_damping_ratio": "/ 2.5 .. * 2.5",
}


def rig_pair(**changes):
    """A pair whose uncertain inputs are those of ``RANGES`` alone; all other values are known."""
    pair = spurcheck.new_pair("19/41", module=2.5, face_width=20, speed=1450, torque=80, stiffness="energy")
    known = {"bearings.stiffness": 2e8, "friction": {"law": "coulomb", "coefficient": 0.05}}
    known |= {f"{gear}.tip_alteration": 0.0 for gear in ("pinion", "gear")}
    return pair.with_(known).with_({"assumed": {}, "uncertainty": RANGES} | changes)


TRUTH = {"mesh.stiffness_factor": 1.04, "mesh.damping_ratio": 0.07, "bearings.gear.loa_stiffness": 2.6e8}


def rig_record(
    truth, *, rpm=1450.0, noise=0.03, seed=1, quantities=("dte",), cycles=60, per_cycle=64, name="run"
):
    """A record of the motion of a pair: ``noise`` is over the peak to peak of each channel."""
    at = truth.with_({"operating.pinion_speed": rpm})
    prediction = predicted(at.healthy)
    motion = MotionCurves.of(at, prediction.cycle, prediction.mesh_cycles, at.pinion.teeth)
    u = np.arange(cycles * per_cycle) / per_cycle
    rng = np.random.default_rng(seed)
    channels = []
    for quantity in quantities:
        values = motion.at(quantity, u + 0.37)
        values = values + noise * np.ptp(values) * rng.standard_normal(u.size)
        channels.append(Channel(quantity, quantity, values))
    return Curves(
        f"{name} {rpm:g} rpm", "time", u * at.geometry.mesh_period, tuple(channels), role="measurement",
        pinion_speed=at.operating.pinion_speed, pinion_torque=at.operating.pinion_torque,
    )  # fmt: skip

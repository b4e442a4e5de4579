"""Figure 7: normal load and friction force per tooth pair, continuously labelled, beside measurements."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import xarray as xr

from lumped import GearPair, steady_state
from lumped.labelling import Variable, labelled_dataset
from lumped.model.steady import UNSTABLE
from reproductions.he_cho_singh_2008.operating_points import FIGURE_7, OperatingPoint
from reproductions.he_cho_singh_2008.records import FigureRecord, Number
from reproductions.he_cho_singh_2008.twins import (
    SETTLED,
    SPAN,
    agreement,
    continuous_labels,
    roll_angle,
    twins,
)
from validation.check.curves import Curves
from validation.check.motion_curves import MotionCurves
from validation.check.overlay import overlay
from validation.check.problem import Problem
from validation.check.quantities import PAIR_LABELS

LAW = "xu_kahraman"
_CYCLES = 3
_FORCES = {"normal_load": "normal load", "friction_force": "friction force"}


def pair_forces(pair: GearPair, point: OperatingPoint, *, with_multibody: bool = True) -> xr.Dataset:
    """Normal load and friction force of pairs A, B, ... over three mesh cycles at one operating point.

    Returns
    -------
    Dataset over model, label and cycles (mesh cycles since pair A was at A): normal_load, friction_force [N];
    roll_angle [deg] over cycles; attributes with the agreement of the twins
    """
    pair_at_point = point.of(pair).with_({"friction.law": LAW})
    runs = twins({"III": pair_at_point}, with_multibody=with_multibody)
    samples = runs.sizes["phase"]
    cycles = np.arange(_CYCLES * samples) / samples
    variables: dict[str, Variable] = {
        "roll_angle": ("cycles", roll_angle(pair_at_point, cycles), "deg", "pinion roll angle of pair A")
    }
    for name, text in _FORCES.items():
        one = runs[name].isel(variant=0).transpose("model", "pair", "phase").to_numpy()
        labelled = np.array([continuous_labels(model, _CYCLES) for model in one])
        variables[name] = (("model", "label", "cycles"), labelled, "N", f"{text} of a tooth pair")
    attrs: dict[str, float] = {"speed_rpm": point.speed, "torque": point.torque}
    attrs["spectral_radius"] = float(runs["spectral_radius"].max())
    if with_multibody:
        for name, value in agreement(runs, list(_FORCES)).items():
            attrs[f"rms_difference_{name}"] = value
        attrs["unsettled"] = float(runs["unsettled"].max())
    return labelled_dataset(
        variables,
        {
            "model": (runs["model"].to_numpy(), "1", "model"),
            "label": (list(PAIR_LABELS[: pair_at_point.geometry.pairs]), "1", "tooth pair"),
            "cycles": (cycles, "1", "mesh cycles since pair A was at A"),
        },
        attrs,
    )


def measured_points(pair: GearPair, record: Curves, *, bins: int = 48) -> xr.Dataset:
    """A record of tooth-pair forces laid over law III at its operating point: bins and metrics by channel.

    Parameters
    ----------
    pair : the gear pair
    record : the record
    bins : points per passage
    """
    at_record = record.at(pair.with_({"friction.law": LAW}))
    again = record.recurrence or pair.pinion.teeth
    motion = MotionCurves.of(at_record, steady_state(at_record, samples_per_cycle=1024), 1, again)
    problem = Problem.of(at_record, record, motion)
    points = overlay(problem, bins=bins)
    points["quantity"] = ("channel", [channel.quantity for channel in record.channels])
    points["label"] = ("channel", [channel.tooth_pair or "" for channel in record.channels])
    # Pair B follows A by one mesh cycle, C by two.
    delay = [PAIR_LABELS.index(channel.tooth_pair or "A") for channel in record.channels]
    points["cycles"] = points["phase"] + xr.DataArray(delay, dims="channel")
    return points.assign_attrs(
        speed_rpm=at_record.operating.pinion_speed * 30.0 / math.pi,
        torque=at_record.operating.pinion_torque,
        shift=problem.misfit.shift,
    )


def figure7(
    pair: GearPair, measurements: Sequence[Curves] = (), *, with_multibody: bool = True
) -> FigureRecord:
    """Figure 7 with its data and numbers.

    Parameters
    ----------
    pair : the gear pair
    measurements : records to lay over it; each goes to the panel of its speed
    with_multibody : also run the multibody twin
    """
    data = {
        f"{point.speed:.0f}rpm": pair_forces(pair, point, with_multibody=with_multibody) for point in FIGURE_7
    }
    numbers: dict[str, Number] = {}
    for part in data.values():
        speed = f"{part.attrs['speed_rpm']:g} rpm"
        lumped = part.sel(model="lumped")
        for name, text in _FORCES.items():
            largest = float(np.abs(lumped[name]).max())
            numbers[f"{speed}: largest {text} of a pair"] = Number(largest, "N")
            if with_multibody:
                numbers[f"{speed}: multibody twin, total {text}: rms difference"] = Number(
                    100 * part.attrs[f"rms_difference_{name}"], SPAN
                )
        numbers[f"{speed}: largest Floquet multiplier"] = Number(part.attrs["spectral_radius"])
        if with_multibody:
            numbers[f"{speed}: {SETTLED}"] = Number(100 * part.attrs["unsettled"], SPAN)
    unstable = [
        f"{d.attrs['speed_rpm']:g} rpm" for d in data.values() if d.attrs["spectral_radius"] > UNSTABLE
    ]
    for j, measurement in enumerate(measurements):
        points = measured_points(pair, measurement)
        data[f"measured{j + 1}"] = points
        for channel in points["channel"].to_numpy():
            relative = 100 * float(points["relative_rms"].sel(channel=channel))
            numbers[f"{measurement.name}, {channel}: rms of measured - predicted"] = Number(relative, SPAN)
    return FigureRecord(
        number="7",
        title="Normal load and friction force per tooth pair, law III",
        text=(
            f"Tooth pairs A and B followed through the mesh at {FIGURE_7[0].torque:g} N m, "
            f"{FIGURE_7[0].speed:g} and {FIGURE_7[1].speed:g} rpm, law III, lumped model and its multibody "
            "twin. "
            + (f"Warning: unstable at {', '.join(unstable)}; a pair would leave it. " if unstable else "")
            + (
                "Points: measured means per phase bin with their scatter."
                if measurements
                else "The measured values of the paper are not published as numbers; records given to this "
                "figure are laid over it."
            )
        ),
        numbers=numbers,
        data=data,
    )

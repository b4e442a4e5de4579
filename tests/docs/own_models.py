"""Files that readers of the how-to pages have: of MATLAB, a multibody program, ROSS and a rig."""

from pathlib import Path
from textwrap import dedent

import numpy as np
import pandas as pd
import scipy.io

from lumped.schema.pair import GearPair
from validation.check.motion_curves import MotionCurves
from validation.check.reference import lumped_motion

#: Mesh cycles of all curves, and samples in a cycle.
CYCLES, PER_CYCLE = 5, 400
#: A mesh of ROSS, by the attributes of ``ross.Mesh`` and ``GearElementTVMS`` of ROSS 2.3: 30/60 teeth,
#: module 2 mm. Masses m = rho pi (r^2 - r_i^2) b, moments of inertia m (r^2 + r_i^2)/2, the contact ratio by
#: both tip circles. The stiffness is that of spurcheck by the method of ROSS.
ROTOR = """
from types import SimpleNamespace

import numpy as np

import spurcheck

ANGLE = np.deg2rad(20.0)
STEEL = SimpleNamespace(E=206e9, Poisson=0.3, rho=7850.0)


def gear(teeth):
    radius, inner = 0.001 * teeth, 0.01
    mass = 7850.0 * np.pi * (radius**2 - inner**2) * 0.02
    return SimpleNamespace(
        n_teeth=teeth, module=0.002, width=0.02, bore_diameter=2 * inner, pr_angle=ANGLE, addendum_coeff=1.0,
        tip_clearance_coeff=0.25, base_radius=radius * np.cos(ANGLE), material=STEEL, m=mass,
        Ip=mass * (radius**2 + inner**2) / 2,
    )


changes = {
    "gears.bore": 20, "gears.youngs_modulus": 206, "gears.poisson_ratio": 0.3, "mesh.contact": "prescribed",
    "mesh.stiffness": {"model": "energy", "hertz": "linear"}, "mesh.relief": "ignored",
    "basic_rack.fillet_radius_coefficient": float(0.25 / (1 - np.sin(ANGLE))),
}
ours = spurcheck.new_pair("30/60", module=2, face_width=20, speed=1500, torque=50, changes=changes)
stiffness = spurcheck.mesh_stiffness(ours)["mesh_stiffness"].to_numpy()
path = sum(np.sqrt((r + 2) ** 2 - (r * np.cos(ANGLE)) ** 2) for r in (30, 60)) - 90 * np.sin(ANGLE)
mesh = SimpleNamespace(
    driving_gear=gear(30), driven_gear=gear(60), helix_angle=0.0,
    contact_ratio=path / (2 * np.pi * np.cos(ANGLE)), stiffness_range=np.append(stiffness, stiffness[0]),
)
"""


def write_own_models(pair: GearPair, folder: Path) -> None:
    """Write right curves of a pair as its readers have them, and in theirs.csv those of softer bearings."""
    motion = lumped_motion(pair)
    softer = pair.with_({"bearings.stiffness": 0.8 * pair.bearings.pinion.loa_stiffness})
    _text(lumped_motion(softer), folder / "theirs.csv")
    _matlab(motion, folder)
    _multibody(motion, folder / "multibody.csv")
    (folder / "my_rotor.py").write_text(dedent(ROTOR))


def _sampled(motion: MotionCurves, *quantities: str) -> tuple[np.ndarray, list[np.ndarray]]:
    """Times [s] and quantities [SI], from 0.3 mesh cycles behind A on."""
    cycles = np.arange(CYCLES * PER_CYCLE) / PER_CYCLE
    curves = [motion.at(name, cycles + 0.3) for name in quantities]
    return cycles * motion.pair.geometry.mesh_period, curves


def _text(motion: MotionCurves, path: Path) -> None:
    time, (dte, x_p, force) = _sampled(motion, "dte", "x_p", "mesh_force")
    columns = {"time [s]": time, "dte [um]": 1e6 * dte, "x_p [um]": 1e6 * x_p, "mesh_force [N]": force}
    pd.DataFrame(columns).to_csv(path, index=False)


def _matlab(motion: MotionCurves, folder: Path) -> None:
    """A .mat file as save -v7 writes it, columns (k, 1), and a structure with time of Simulink."""
    time, (dte, x_p, y_p, force) = _sampled(motion, "dte", "x_p", "y_p", "mesh_force")
    g = motion.pair.geometry
    column = {
        "time_s": time,
        "te_um": 1e6 * dte,
        "x1_um": 1e6 * x_p,
        "y1_um": 1e6 * y_p,
        "mesh_force_N": force,
    }
    numbers = {"contact_ratio": g.contact_ratio, "base_radius_pinion": g.base_radius_pinion}
    scipy.io.savemat(
        folder / "model.mat", {name: values[:, None] for name, values in column.items()} | numbers,
        do_compression=True,
    )  # fmt: skip
    signals = np.zeros((1, 2), dtype=[("values", object), ("dimensions", object), ("label", object)])
    for place, (label, values) in enumerate((("te_um", 1e6 * dte), ("x1_um", 1e6 * x_p))):
        signals[0, place] = (values[:, None], np.array([[1.0]]), label)
    simout = {"time": time[:, None], "signals": signals, "blockName": "stage/To Workspace"}
    scipy.io.savemat(folder / "simulink.mat", {"simout": simout})


def _multibody(motion: MotionCurves, path: Path) -> None:
    """Rotations about one axis Z as ramps [deg], centres in global axes [mm].

    Unit vectors by hand: the line of action is the common tangent of both base circles that carries the load
    of a pinion that turns counter-clockwise, with the gear at +X. From the pinion's tangent point, at the
    angle alpha_w behind the line of centres, it points to that of the gear.
    """
    names = ("theta_p", "theta_g", "x_p", "x_g", "y_p", "y_g", "mesh_force")
    time, (theta_p, theta_g, x_p, x_g, y_p, y_g, force) = _sampled(motion, *names)
    pair = motion.pair
    g = pair.geometry
    centres = np.array([g.base_radius_pinion + g.base_radius_gear, 0.0]) / np.cos(g.operating_pressure_angle)
    radial = np.array([np.cos(g.operating_pressure_angle), -np.sin(g.operating_pressure_angle)])
    start = g.base_radius_pinion * radial
    end = centres - g.base_radius_gear * radial
    along = (end - start) / np.linalg.norm(end - start)
    assert np.isclose(np.linalg.norm(end - start), g.L_XY)
    # Material of the pinion on the line moves along -y: Z x (place on the line less the centre).
    sweep = np.array([-along[1], along[0]])
    across = -sweep
    turns = pair.operating.pinion_speed * time
    table = {
        "time [s]": time,
        "PINION.RZ [deg]": np.degrees(turns + theta_p),
        "GEAR.RZ [deg]": -np.degrees(turns * pair.pinion.teeth / pair.gear.teeth + theta_g),
        "CONTACT.FN [N]": force,
    }
    for name, x, y in (("PINION", x_p, y_p), ("GEAR", x_g, y_g)):
        for place, axis in enumerate("XY"):
            table[f"{name}.{axis} [mm]"] = 1e3 * (x * along[place] + y * across[place])
    pd.DataFrame(table).to_csv(path, index=False, float_format="%.12g")


def write_record(pair: GearPair, folder: Path) -> None:
    """Write measurement.toml and its CSV: forces of a gauged tooth over two revolutions, with 1 % noise."""
    motion = lumped_motion(pair, recurrence=pair.pinion.teeth)
    cycles = np.arange(0.0, 2.0 * pair.pinion.teeth, 1.0 / 100.3)
    rng = np.random.default_rng(1)
    columns = {"t": cycles * pair.geometry.mesh_period * 1e3}
    text = [
        'name = "tooth forces"', 'source = "computed"', 'data = "run12.csv"',
        f"pinion_speed = {float(pair.operating.pinion_speed) * 30 / np.pi!r}",
        f"pinion_torque = {float(pair.operating.pinion_torque)!r}", f"recurrence = {pair.pinion.teeth}",
        "[abscissa]", 'kind = "time"', 'column = "t"', 'unit = "ms"',
    ]  # fmt: skip
    for name, column in (("normal_load", "Fn"), ("friction_force", "Ff")):
        values = motion.at(name, cycles + 0.37, "A")
        noise = 0.01 * float(np.ptp(values))
        columns[column] = values + noise * rng.standard_normal(cycles.size)
        text += [
            "[[channel]]", f'name = "{column}"', f'column = "{column}"', f'quantity = "{name}"', 'unit = "N"',
            'pair = "A"', f"noise = {noise!r}",
        ]  # fmt: skip
    pd.DataFrame(columns).to_csv(folder / "run12.csv", index=False)
    (folder / "measurement.toml").write_text("\n".join(text))

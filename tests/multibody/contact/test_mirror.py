"""Does a 1:1 pair give the mirror image of its motion when pinion and gear change places?"""

import numpy as np

import lumped
import multibody
from multibody.contact import kernels as kn
from multibody.contact import kinematics
from multibody.run.setup import prepare
from multibody.run.simulation import record

FIRST, SECOND = {"loa": 1.0e8, "oloa": 1.0e8}, {"loa": 0.6e8, "oloa": 0.6e8}
CYCLES = 6


def make(pinion_bearing, gear_bearing, bores):
    """A 1:1 pair whose two gears differ in bearing and bore (so in mass and inertia) only.

    Stiffness of a bearing is the same in both directions, so that it looks the same in the mirror.
    """
    bearings = {
        f"bearings__{gear}__{axis}_stiffness": value
        for gear, bearing in (("pinion", pinion_bearing), ("gear", gear_bearing))
        for axis, value in bearing.items()
    }
    return lumped.load_gear_pair("nasa_28_28").with_(
        mesh__relief="ignored",
        friction__law="coulomb",
        friction__coefficient=0.08,
        operating__pinion_speed=2500,
        pinion__bore=bores[0],
        gear__bore=bores[1],
        **bearings,
    )


def on_flank(machine, flank):
    """Distances of the two flanks from their tangent points at t = 0, without deviations [m]."""
    p = machine.parameters
    chi_p, apart = (kn.CHI_P, kn.APART) if flank > 0 else (kn.CHI_P_BACK, kn.APART_BACK)
    psi = kinematics.line_of_action(0.0, 0.0, p[kn.L_XY], p[kn.RADIUS_P] + p[kn.RADIUS_G], flank)[3]
    rho_p = flank * p[kn.RADIUS_P] * (psi - p[chi_p])
    overlap = flank * (p[kn.RADIUS_P] + p[kn.RADIUS_G]) * psi + p[apart]
    return rho_p, p[kn.L_XY] + overlap - rho_p


def test_swapping_pinion_and_gear_mirrors_the_run():
    """The mirror lies in the common tangent of the pitch circles.

    It maps each gear's place onto the other's and turns clockwise into counter-clockwise, so both gears keep
    their running senses; the drive flank becomes the back side. The pair with gears swapped, its gear driving
    and its pinion braked, must therefore run through the mirror image of every state, back sides in contact.
    """
    pair, swapped = make(FIRST, SECOND, (20.0, 10.0)), make(SECOND, FIRST, (10.0, 20.0))
    run = multibody.simulate(pair, CYCLES, rtol=1e-10, samples_per_cycle=64)
    setup, image = prepare(pair), prepare(swapped)
    p = setup.machine.parameters
    along = np.array([p[kn.CENTRE_GX] - p[kn.CENTRE_PX], p[kn.CENTRE_GY] - p[kn.CENTRE_PY]])
    mirror = np.eye(2) - 2.0 * np.outer(along, along) / (along @ along)

    # Rotations that put the image's back sides where the mirror shows the drive flanks: rho_p and rho_g
    # change places. On the back side rho grows with the pinion's phi_p = -theta_p and the gear's theta_g.
    radius = p[kn.RADIUS_P]
    rho_p, rho_g = on_flank(setup.machine, 1.0)
    back_p, back_g = on_flank(image.machine, -1.0)
    turn_p, turn_g = (back_p - rho_g) / radius, (rho_p - back_g) / radius

    def mirrored(values):
        """(theta_p, theta_g, x_p, x_g, y_p, y_g) -> those of the image, rotations without the offset."""
        theta_p, theta_g, x_p, x_g, y_p, y_g = values
        pinion, gear = mirror @ np.array([x_g, y_g]), mirror @ np.array([x_p, y_p])
        return np.array([theta_g, theta_p, pinion[0], gear[0], pinion[1], gear[1]])

    names = lumped.periodic_system(pair, "full").state_names
    history = np.stack([run[name].to_numpy() for name in names])
    expected, rates = mirrored(history[:6]), mirrored(history[6:])
    expected[:2] += np.array([turn_p, turn_g])[:, None]
    start = prepare(swapped, initial=np.concatenate([expected[:, 0], rates[:, 0]]), rtol=1e-10)
    torques = -run.attrs["brake_torque"], -run.attrs["pinion_torque"]
    seen, _, _ = record(start.with_torques(*torques), CYCLES, 64)
    # Two runs at rtol 1e-10 over some thousand steps. The image's rotations are far from zero, where a
    # relative tolerance allows more: 1e-10 x 0.01 rad x 42 mm = 4e-14 m per step, 1e-8 of the motion.
    for name, wanted in zip(names, np.concatenate([expected, rates]), strict=True):
        span = float(np.ptp(wanted))
        assert float(np.abs(seen[name].to_numpy() - wanted).max()) < 1e-7 * span, name
    assert float(np.abs(seen["normal_load"]).max()) == 0.0  # the drive flanks never touch
    loads = (run["normal_load"].sum("pair"), seen["normal_load_back"].sum("pair"))
    assert float(loads[0].max()) > 1.3 * float(loads[0].mean())  # a run with something to mirror
    off = np.abs(loads[0] - loads[1]).to_numpy()
    # A sample on a switch belongs to either side of the jump.
    assert np.quantile(off, 0.97) < 1e-7 * float(loads[0].max())

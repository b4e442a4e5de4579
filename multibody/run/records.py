"""From integrated states to the labelled variables that the lumped model returns."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from lumped.model.results import labelled
from lumped.typing import FloatArray
from multibody.contact import kernels as kn
from multibody.run.integration import Segment
from multibody.run.model import ExudynModel, contact_state

if TYPE_CHECKING:
    import xarray as xr


_COORDINATES = ("theta_p", "theta_g", "x_p", "x_g", "y_p", "y_g")
# q = (x_p, y_p, phi_p, x_g, y_g, phi_g) out of (theta_p, theta_g, x_p, x_g, y_p, y_g): theta_p = -phi_p.
_ORDER = np.array([2, 4, 0, 3, 5, 1])
_SIGN = np.array([1.0, 1.0, -1.0, 1.0, 1.0, 1.0])
_BACK = np.argsort(_ORDER)

#: Variables beyond those of the lumped model: name -> (dimensions, unit, plain name).
EXTRA = {
    "overlap": (("time",), "m", "overlap of the driving flanks along the actual line of action"),
    "normal_load_back": (("pair", "time"), "N", "normal load on the back sides of the teeth"),
}


def from_lumped_state(state: FloatArray) -> tuple[FloatArray, FloatArray]:
    """(q, v) of the multibody model, each (..., 6), from the 12 lumped states (..., 12)."""
    return state[..., _ORDER] * _SIGN, state[..., 6 + _ORDER] * _SIGN


def to_lumped_state(q: FloatArray, v: FloatArray) -> FloatArray:
    """The 12 lumped states (..., 12) from q and v, each (..., 6)."""
    return np.concatenate([(q * _SIGN)[..., _BACK], (v * _SIGN)[..., _BACK]], axis=-1)


#: Per-pair variables that a contact record holds as they are.
_COLUMNS = {
    "mu": kn.MU,
    "normal_load": kn.LOAD,
    "friction_force": kn.FRICTION_FORCE,
    "sliding_velocity": kn.SLIDE,
    "position": kn.XI,
}


class Recorder:
    """Collects states and contacts at the output times while the integration runs.

    Parameters
    ----------
    model : the model that is integrated; its force core is evaluated again at the output times
    time : (n,) output times, increasing [s]
    """

    def __init__(self, model: ExudynModel, time: FloatArray) -> None:
        self.model, self.time = model, time
        machine, p, n = model.machine, model.machine.parameters, time.size
        self.q, self.v = np.zeros((n, machine.size)), np.zeros((n, machine.size))
        phase = time / machine.period
        self.advance = np.maximum(phase - np.floor(phase + 1e-9), 0.0) * p[kn.PITCH]
        ahead = np.arange(machine.ahead, machine.ahead - machine.pairs, -1)[:, None] * p[kn.PITCH]
        self.pairs = {
            name: np.zeros((machine.pairs, n)) for name in (*_COLUMNS, "contact", "normal_load_back")
        }
        self.pairs["position"] += p[kn.L_XA] + ahead + self.advance  # a pair out of contact: nominal
        self.stiffness, self.overlap = np.zeros(n), np.full(n, np.nan)

    def visit(self, segment: Segment, start: float, stop: float) -> None:
        """Record the output times in [start, stop)."""
        slack = 1e-9 * self.model.machine.period
        low, high = np.searchsorted(self.time, [start - slack, stop - slack])
        if low == high:
            return
        inside = np.clip(self.time[low:high], segment.times[0], segment.times[-1])
        self.q[low:high], self.v[low:high] = segment.at(inside)
        self._contacts(int(low), int(high))

    def finish(self, q: FloatArray, v: FloatArray, end: float) -> None:
        """Record the last output time, as the first instant of the cycle that would follow."""
        p, period = self.model.parameters, self.model.machine.period
        self.q[-1], self.v[-1] = q, v
        if np.isfinite(p[kn.T_LOW]):
            p[kn.T_LOW], p[kn.T_HIGH] = end + 1e-12 * period, end + 1e-9 * period
        self._contacts(self.time.size - 1, self.time.size)

    def _contacts(self, low: int, high: int) -> None:
        """Evaluate the contacts at output times low ... high - 1 and sort them into the pairs' slots."""
        machine, part = self.model.machine, slice(low, high)
        _, contacts, count = contact_state(self.model, self.time[part], self.q[part], self.v[part])
        p, slots = machine.parameters, machine.pairs
        for j in range(int(count.max(initial=0))):
            found = np.flatnonzero(j < count)
            record, rows = contacts[found, j], low + found
            # Whole pitches ahead of the newest nominal position; a pair that enters early or leaves late
            # takes the slot of the pair that is out of contact.
            pitches = np.rint((record[:, kn.XI] - p[kn.L_XA] - self.advance[rows]) / p[kn.PITCH])
            slot = np.mod(machine.ahead - pitches.astype(int), slots)
            drive = record[:, kn.FLANK] > 0
            at = (slot[drive], rows[drive])
            for name, column in _COLUMNS.items():
                self.pairs[name][at] = record[drive, column]
            self.pairs["contact"][at] = 1.0
            np.add.at(self.pairs["normal_load_back"], (slot[~drive], rows[~drive]), record[~drive, kn.LOAD])
            self.stiffness[rows[drive]] += record[drive, kn.K]
            self.overlap[rows[drive]] = record[drive, kn.OVERLAP]

    def dataset(self, attributes: Mapping[str, Any]) -> xr.Dataset:
        """Return everything recorded under the lumped model's names."""
        import xarray as xr

        p, per_pair = self.model.machine.parameters, dict(self.pairs)
        back = per_pair.pop("normal_load_back")
        values = self._motion() | per_pair
        nominal = (p[kn.OMEGA_P] + p[kn.OMEGA_G]) * (per_pair["position"] - p[kn.L_XP])
        values |= {
            "friction_power_nominal": -per_pair["friction_force"] * nominal,
            "mesh_stiffness": self.stiffness,
            "friction_power": -per_pair["friction_force"] * per_pair["sliding_velocity"],
        }
        result = labelled(self.time, values, attributes)
        overlap = np.where(np.isnan(self.overlap), values["dte"], self.overlap)
        for name, data in (("overlap", overlap), ("normal_load_back", back)):
            dims, unit, text = EXTRA[name]
            result[name] = xr.DataArray(data, dims=dims, attrs={"units": unit, "long_name": text})
        train = self.model.machine.train
        if train is not None:
            result["bearing_force"] = xr.DataArray(
                train.bearing_force(self.q, self.v),
                {"bearing": list(train.bearing_names), "direction": ["loa", "oloa"], "time": result["time"]},
                dims=("bearing", "direction", "time"),
                attrs={"units": "N", "long_name": "force of each bearing on its shaft"},
            )
        return result

    def _motion(self) -> dict[str, FloatArray]:
        """Coordinates, rates, transmission error and bearing forces."""
        machine = self.model.machine
        states = [f"{name}{suffix}" for suffix in ("", "_dot") for name in _COORDINATES]
        q, v = self.q[:, :6], self.v[:, :6]
        values = dict(zip(states, to_lumped_state(q, v).T, strict=True))
        values |= {"dte": q @ machine.overlap, "dte_dot": v @ machine.overlap}
        if machine.train is not None:
            force, names = machine.train.bearing_force(self.q, self.v), machine.train.bearing_names
            for gear, name in (("p", "pinion"), ("g", "gear")):
                own = [i for i, bearing in enumerate(names) if bearing.startswith(name)]
                for j, axis in enumerate("xy"):
                    values[f"bearing_force_{axis}_{gear}"] = force[own, j].sum(axis=0)
            return values
        stiffness, damping = machine.bearing_stiffness, machine.bearing_damping
        for i, gear in enumerate("pg"):
            for j, axis in enumerate("xy"):
                name = f"{axis}_{gear}"
                values[f"bearing_force_{name}"] = -(
                    stiffness[i, j] * values[name] + damping[i, j] * values[f"{name}_dot"]
                )
        return values

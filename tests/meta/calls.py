"""One call of every public function that takes a pair: the table that tests of all functions share.

A function without a row fails ``test_supports``. A call takes the pair, an empty folder and keywords of the
function, ``supports`` or ``contact``; it returns the result of the function, or what a file holds that the
function writes.
"""

from __future__ import annotations

import dataclasses
import functools
import importlib
import inspect
from collections.abc import Mapping

import numpy as np
import pytest
import xarray as xr

import floquet
import lumped
import validation
from lumped.model.periodic_system import LTVSystem, without_shafts
from tests.meta.test_public_names import FUNCTIONS
from tests.validation.check.record.tooth_forces import tooth_force_record
from tests.validation.reporting.written import without_variant
from validation import exchange, studies
from validation.check import check
from validation.check.curves import Channel, Curves
from validation.check.reference import lumped_motion
from validation.interactive.results import Sampling
from validation.plots import style
from validation.reporting import build
from validation.reporting.effort import QUICK

PUBLIC = {one.id: one.values[0] for one in FUNCTIONS}
#: Words of an annotation by which a function gets a pair, or what holds one.
_PAIRS = ("GearPair", "GearVariation", "AnyPair", "Study", "ResponseBranches")
#: A quick report as small as it can be: no search for jumps, which ends at another place in each run.
FEW = dataclasses.replace(
    QUICK, sweep_speeds=9, chart_speeds=21, chart_dampings=5, orders_speeds=9, jump_seconds=0.001
)
SPEEDS = [2000.0, 2600.0]
ENDS = (2000.0, 2100.0)
#: The module, which the function of the same name hides.
search = importlib.import_module("validation.calibrate.calibrate")


def _takes_a_pair(function):
    signature = inspect.signature(function)
    return any(
        word in str(one.annotation) for one in signature.parameters.values() for word in _PAIRS
    ) or not {"pair", "supports"}.isdisjoint(signature.parameters)


WITH_PAIRS = sorted(name for name, function in PUBLIC.items() if _takes_a_pair(function))


def numbers(value):
    """All numbers of a result in one array, whatever holds them."""
    if isinstance(value, xr.Dataset):
        return numbers([value[name].to_numpy() for name in value.data_vars])
    if isinstance(value, xr.DataArray):
        return numbers(value.to_numpy())
    if isinstance(value, Mapping):
        return numbers(list(value.values()))
    if isinstance(value, (list, tuple)):
        return np.concatenate([np.zeros(0), *map(numbers, value)])
    if isinstance(value, floquet.PeriodicSystem):
        return numbers(value.evaluate(np.array([0.3]) * value.period))
    if isinstance(value, floquet.RankOneSystem):
        return numbers([value.stiffness, value.damping, value.v])
    if isinstance(value, LTVSystem):
        return numbers([value.constant, value.deflection])
    if isinstance(value, lumped.GearPair):
        return np.zeros(0)
    if dataclasses.is_dataclass(value):
        return numbers([getattr(value, field.name) for field in dataclasses.fields(value)])
    array = np.asarray(value)
    if array.dtype.kind not in "biufc":
        return np.zeros(0)
    array = array.astype(complex).ravel()
    return np.nan_to_num(np.concatenate([array.real, array.imag]), nan=-1.0)


def _study(pair, folder, supports=None):
    """Results of a study of two speeds."""
    settings = {"samples_per_cycle": 32} | ({} if supports is None else {"supports": supports})
    study = studies.load_study(
        {
            "name": "held",
            "gear_pair": pair.to_mapping(),
            "analysis": "lumped",
            "outputs": ["dte_rms"],
            "axes": [{"field": "operating.pinion_speed", "values": SPEEDS}],
            "settings": settings,
        }
    )
    studies.run_sweep(study, folder / "sweep", workers=0)
    return studies.read_results(folder / "sweep")


def _record(pair):
    """A record of tooth forces, whatever holds the gears of the pair that it is compared with."""
    return tooth_force_record(
        lumped_motion(without_shafts(pair).healthy, recurrence=7), seed=1, engagements=10
    )


def _calibrated(pair, **held):
    """Posterior of one input, by a record of the pair's own motion with a little noise.

    From one start for each form: what all starts find is tested where they stand.
    """
    pair = pair.with_(CHANGES["validation.calibrate.calibrate"])
    prediction = validation.predict(pair.healthy, **held)
    swing = prediction.cycle["dte"].to_numpy()
    cycles = np.arange(20 * swing.size) / swing.size * prediction.mesh_cycles
    noise = 0.01 * np.ptp(swing) * np.random.default_rng(1).standard_normal(cycles.size)
    channel = Channel("dte", "dte", np.tile(swing, 20) + noise)
    record = Curves("rig", "mesh_cycles", cycles, (channel,), "measurement")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(search, "starts", functools.partial(search.starts, count=1))
        patch.setattr(search, "_DRAWN", 1)
        return search.calibrate(pair, record, machines=16, **held)


def _page_one(pair, folder, **held):
    """Numbers of page 1 of a quick report of few samples, whose figures are drawn but not saved."""
    with pytest.MonkeyPatch.context() as patch:
        without_variant(patch)
        patch.setattr(build, "QUICK", FEW)
        patch.setattr(style, "save", lambda figure, path, **_: path.write_bytes(b"<svg/>"))
        written = validation.report(pair, folder / "report", quick=True, force=True, **held)
    return [row.value for row in written.first.numbers]


def _nearest(pair, folder=None, **held):
    """Search near the operating speed: a search of the whole range takes seconds."""
    rpm = pair.operating.pinion_speed * 30.0 / np.pi
    return floquet.nearest_unstable_speed(pair, (0.8 * rpm, 1.2 * rpm), **held)


def _page(pair, folder, **held):
    """Numbers of a coarse interactive page."""
    sampling = Sampling(speeds=3, dampings=2, slices=2, sweep_speeds=3)
    page = validation.write_interactive_page(pair, folder / "page.html", sampling=sampling, **held)
    return exchange.read_netcdf(page.with_suffix(".nc"))


def _matrices(pair, folder, **held):
    path = exchange.write_state_space(pair, folder / "pair.npz", **held)
    with np.load(path) as file:
        return [file[name] for name in "ABCD"]


def _of(name, *arguments, **fixed):
    """The call of a function whose arguments depend on neither the pair nor the folder."""

    def call(pair, folder=None, **held):
        varied = pair.with_(CHANGES[name]) if name in CHANGES else pair
        return PUBLIC[name](varied, *arguments, **(fixed | held))

    return call


#: Function -> how the pair is varied first.
CHANGES = {
    "floquet.stability_boundaries": {"mesh.damping_ratio": 0.0},
    "validation.calibrate.calibrate": {
        "assumed": {},
        "pinion.tip_alteration": 0.0,
        "gear.tip_alteration": 0.0,
        "uncertainty": {"mesh.damping_ratio": "/ 2 .. * 2"},
    },
    "validation.compare": {"uncertainty": {"mesh.damping_ratio": "+- 10 %"}},
    "validation.uncertainty": {"uncertainty": {"mesh.damping_ratio": "+- 10 %"}},
}
#: Function -> call; on the shafts of a pair that has them by default.
COMPUTED = {
    "lumped.natural_frequencies": _of("lumped.natural_frequencies"),
    "lumped.periodic_system": _of("lumped.periodic_system"),
    "lumped.run_up": _of("lumped.run_up", ENDS, 0.04),
    "lumped.simulate": _of("lumped.simulate", 2, samples_per_cycle=16),
    "lumped.speed_sweep": _of("lumped.speed_sweep", SPEEDS),
    "lumped.steady_state": _of("lumped.steady_state"),
    "multibody.attribution": _of("multibody.attribution"),
    "multibody.simulate": _of("multibody.simulate", 1, samples_per_cycle=8),
    "multibody.steady_state": _of("multibody.steady_state", samples_per_cycle=8),
    "floquet.gear_block": _of("floquet.gear_block"),
    "floquet.gear_pair_multipliers": _of("floquet.gear_pair_multipliers"),
    "floquet.gear_pair_system": _of("floquet.gear_pair_system"),
    "floquet.nearest_unstable_speed": _nearest,
    "floquet.predicted_lines": _of("floquet.predicted_lines", 2),
    "floquet.revolution_multipliers": _of("floquet.revolution_multipliers"),
    "floquet.stability_boundaries": _of("floquet.stability_boundaries", ENDS, nodes=20, orders=2),
    "floquet.stability_chart": _of("floquet.stability_chart", {"speed_rpm": SPEEDS}),
    "validation.dynamic_factor": _of("validation.dynamic_factor"),
    "validation.predict": _of("validation.predict"),
    "validation.report": _page_one,
    "validation.compare": lambda pair, folder, **held: validation.compare(
        pair.with_(CHANGES["validation.compare"]),
        pair.with_(CHANGES["validation.compare"] | {"mesh.damping_ratio": 1.1 * pair.mesh.damping_ratio}),
        samples=16,
        **held,
    ),
    "validation.uncertainty": _of("validation.uncertainty", 16),
    "validation.calibrate.calibrate": lambda pair, folder, **held: _calibrated(pair, **held),
    "validation.check.check": lambda pair, folder, **held: check(pair, _record(pair), explain=False, **held),
    "validation.studies.run_sweep": _study,
}
#: Function -> call; refused for a pair with shafts unless springs are asked for.
REFUSED = {
    "lumped.averaged_state_space": lambda pair, folder, **held: [
        getattr(lumped.averaged_state_space(pair, **held), name) for name in "ABCD"
    ],
    "multibody.monodromy": _of("multibody.monodromy", fidelity="linear"),
    "multibody.power_balance": _of("multibody.power_balance", 1),
    "multibody.speed_sweep": _of(
        "multibody.speed_sweep", SPEEDS[:1], settle=0, cycles=1, samples_per_cycle=8
    ),
    "floquet.campbell": _of("floquet.campbell", SPEEDS),
    "floquet.jump_map": _of("floquet.jump_map", {"speed_rpm": [2000.0, 2010.0], "torque": [60.0]}, (1,)),
    "floquet.long_run": _of("floquet.long_run", settle_cycles=1, cycles=64),
    "floquet.periodic_orbit": _of("floquet.periodic_orbit"),
    "floquet.response_branches": _of("floquet.response_branches", ENDS, (1,), seeds=0),
    # Without the time that it took.
    "floquet.search_jumps": lambda pair, folder, **held: (
        floquet.search_jumps(pair, [ENDS], seconds=100.0, seeds=0, speeds=ENDS, **held).branches
    ),
    "floquet.stability_margins": _of("floquet.stability_margins", ENDS),
    "validation.crosscheck": _of(
        "validation.crosscheck", cycles=6, samples_per_cycle=32, fidelities=("linear",)
    ),
    "validation.write_interactive_page": _page,
    "validation.exchange.write_state_space": _matrices,
}
#: Function -> call, in which supports do not enter: geometry, stiffness, friction, statics, rigid bearings.
WITHOUT = {
    name: _of(name)
    for name in (
        "lumped.bodies", "lumped.geometry", "lumped.meeting_teeth", "lumped.mesh_cycle",
        "lumped.mesh_elements", "lumped.mesh_stiffness", "lumped.optimal_relief", "lumped.plane_compliance",
        "lumped.revolution", "lumped.static_sharing", "lumped.static_transmission_error",
        "lumped.stiffness_components", "lumped.tooth_gaps",
        "lumped.losses.iso_14179_mesh_loss", "lumped.losses.iso_14179_of", "lumped.losses.loss_factor",
        "lumped.losses.losses_of_laws", "lumped.losses.ohlendorf_of", "lumped.losses.quasi_static_losses",
        "lumped.path_of_contact.contact_path", "lumped.path_of_contact.friction_path_function",
        "lumped.path_of_contact.friction_profile", "lumped.path_of_contact.law_range_violations",
        "lumped.path_of_contact.pair_stiffness", "lumped.quasi_static.mesh_positions",
        "floquet.single_degree",
    )
} | {"floquet.single_degree_chart": _of("floquet.single_degree_chart", {"speed_rpm": SPEEDS})}  # fmt: skip
#: Functions that take a result, which names its supports.
OF_RESULTS = {
    "floquet.jumps_removed_by",
    "floquet.label_regions",
    "multibody.motion_balance",
    "validation.validity_flags",
}
#: Function -> call; functions that describe the shafts themselves.
OF_SHAFTS = {name: _of(name) for name in ("lumped.condensed_bearings", "lumped.shaft_modes")}
#: Functions that return, read or write a pair with all its values.
OF_FILES = {
    "lumped.load_gear_pair",
    "lumped.quasi_static.with_tip_relief",
    "validation.exchange.write_rexs",
    "validation.studies.load_study",
}

"""Can your lumped gear model be trusted? The main verbs of spurcheck under one name.

    import spurcheck

    pair = spurcheck.new_pair("19/41", module=2.5, face_width=20, speed=1450, torque=80)
    prediction = spurcheck.predict(pair)
    prediction.dynamic_factor, prediction.efficiency
    prediction.plot().savefig("motion.png")

Pairs      new_pair, load_gear_pair, preset_names, gear_pair_from_rexs; pair.with_(speed=2000) varies one
Motion     predict, dynamic_factor: teeth only push; steady_state, simulate, run_up, speed_sweep, with
           contact="linear", the default, or "unilateral"; response_branches, periodic_orbit
Gears      geometry, mesh_stiffness, natural_frequencies, static_transmission_error, optimal_relief, bodies
Trust      report, uncertainty, compare, validity_flags; crosscheck, whose result has attribution() and
           power_balance()
Your model check: curves of another model, or a record, beside both programs; reference, reference_names
Your rig   calibrate: what records say about the assumed inputs
Stability  stability_chart, stability_margins, stability_boundaries, campbell
Any system PeriodicSystem, periodic_system, from_second_order, monodromy; averaged_state_space, the pair
           as a StateSpace of python-control
Signals    order_spectrum, waterfall, time_synchronous_average; more in spurcheck.validation.signals
Studies    load_study, run_sweep, read_results; open_cluster: they run on a Dask cluster
Files      plot, write_results, write_rexs, write_interactive_page
Errors     SpurcheckError: ParameterError (an input), NumericalError (a computation); LawRangeWarning

``help(spurcheck.predict)`` explains one of them. The packages are attributes too: ``spurcheck.lumped``,
``spurcheck.multibody``, ``spurcheck.floquet``, ``spurcheck.validation``. Where two packages have a function
of the same name, the plain name is that of `lumped` or `floquet`; the multibody model's is
``spurcheck.multibody.simulate``. ``python -m spurcheck`` is the command.

Everything is imported when it is first asked for: ``import spurcheck`` itself loads no package.
"""

from __future__ import annotations

import re
from functools import wraps
from importlib import import_module, metadata
from pathlib import Path
from types import FunctionType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:  # the one list of the public names; below it is read at run time
    import floquet as floquet
    import lumped as lumped
    import multibody as multibody
    import validation as validation
    from floquet import PeriodicSystem as PeriodicSystem
    from floquet import campbell as campbell
    from floquet import from_second_order as from_second_order
    from floquet import monodromy as monodromy
    from floquet import periodic_orbit as periodic_orbit
    from floquet import response_branches as response_branches
    from floquet import stability_boundaries as stability_boundaries
    from floquet import stability_chart as stability_chart
    from floquet import stability_margins as stability_margins
    from lumped import GearPair as GearPair
    from lumped import LawRangeWarning as LawRangeWarning
    from lumped import NumericalError as NumericalError
    from lumped import ParameterError as ParameterError
    from lumped import SpurcheckError as SpurcheckError
    from lumped import averaged_state_space as averaged_state_space
    from lumped import bodies as bodies
    from lumped import geometry as geometry
    from lumped import load_gear_pair as load_gear_pair
    from lumped import mesh_stiffness as mesh_stiffness
    from lumped import natural_frequencies as natural_frequencies
    from lumped import optimal_relief as optimal_relief
    from lumped import periodic_system as periodic_system
    from lumped import preset_names as preset_names
    from lumped import run_up as run_up
    from lumped import simulate as simulate
    from lumped import speed_sweep as speed_sweep
    from lumped import static_transmission_error as static_transmission_error
    from lumped import steady_state as steady_state
    from validation import compare as compare
    from validation import crosscheck as crosscheck
    from validation import dynamic_factor as dynamic_factor
    from validation import plot as plot
    from validation import predict as predict
    from validation import reference as reference
    from validation import reference_names as reference_names
    from validation import report as report
    from validation import uncertainty as uncertainty
    from validation import validity_flags as validity_flags
    from validation import write_interactive_page as write_interactive_page
    from validation.calibrate import calibrate as calibrate
    from validation.check import check as check
    from validation.exchange import gear_pair_from_rexs as gear_pair_from_rexs
    from validation.exchange import new_pair as new_pair
    from validation.exchange import write_results as write_results
    from validation.exchange import write_rexs as write_rexs
    from validation.signals import order_spectrum as order_spectrum
    from validation.signals import time_synchronous_average as time_synchronous_average
    from validation.signals import waterfall as waterfall
    from validation.studies import load_study as load_study
    from validation.studies import open_cluster as open_cluster
    from validation.studies import read_results as read_results
    from validation.studies import run_sweep as run_sweep

    __version__: str

_PACKAGES = ("lumped", "multibody", "floquet", "validation")
#: Public name -> the package that has it.
_SOURCES = {
    name: package
    for package, name in re.findall(
        r"^    from (\S+) import (\w+) as", Path(__file__).read_text("utf-8"), re.M
    )
}
#: What to type instead of a name that no package has.
_INSTEAD = {
    "predict(pair).efficiency": "efficiency losses power_loss",
    "floquet.gear_pair_multipliers(pair).verdict": "is_stable stable",
    "order_spectrum(motion)": "fft spectrum",
    "natural_frequencies(pair)": "resonance resonances critical_speed critical_speeds eigenfrequencies modes",
    "preset_names()": "presets list_presets",
    "crosscheck(pair).attribution()": "attribution causes",
    "crosscheck(pair).power_balance()": "power_balance energy_balance energy",
    "averaged_state_space(pair)": "state_space statespace ss transfer_function frf",
    "predict(pair).bearing_rms": "bearing_force bearing_forces",
}
#: Argument that a function does not have -> advice.
_ARGUMENTS = {
    "model": "The multibody model is spurcheck.multibody.{name}.",
    "contact": "steady_state, simulate and speed_sweep take contact; a prediction has unilateral contact.",
}
#: Argument that a function does not have -> arguments of functions that mean the same.
_SYNONYMS = {
    "n": ("samples", "cycles"),
    "samples": ("samples_per_cycle",),
    "duration": ("cycles",),
    "t_end": ("cycles",),
    "time": ("cycles",),
}
_NAMES = (*_SOURCES, *_PACKAGES, "__version__")


class _PublicNames(list[str]):
    """Names for ``from spurcheck import *``, which takes the items of ``__all__``.

    ``help(spurcheck)`` asks whether a name is in ``__all__`` and prints everything that is, 1,500 lines. Here
    no name is.
    """

    def __contains__(self, name: object) -> bool:
        return False


globals()["__all__"] = _PublicNames((*_SOURCES, *_PACKAGES))  # a plain list would hide names from a checker


def _refuse_foreign_packages() -> None:
    """Stop where another distribution has a package with the name of one of the four of spurcheck.

    Nothing is imported. A foreign package may stand earlier on the path, or may have replaced the files.

    Raises
    ------
    ImportError : one sentence that names the package and says what to do
    """
    from importlib.util import find_spec

    for name in _PACKAGES:
        expected = Path(__file__).resolve().with_name(name) / "__init__.py"
        specification = find_spec(name)
        origin = specification.origin if specification else None
        if origin is None or Path(origin).resolve() != expected:
            place = origin or "a folder without __init__.py" if specification else "nothing"
        elif re.search(
            "spurcheck|gear pair", expected.read_text("utf-8")
        ):  # the docstring of each of the four
            continue
        else:
            place = f"{origin}, which another distribution has replaced"
        raise ImportError(
            f"spurcheck needs its package {name!r}, but Python finds {place}: another distribution has a "
            "package of this name, so install spurcheck into an environment of its own (python -m venv)."
        )


_refuse_foreign_packages()


def _find(name: str) -> object:
    if name == "__version__":
        return metadata.version("spurcheck")
    if name in _PACKAGES:
        return import_module(name)
    value = getattr(import_module(_SOURCES[name]), name)
    import_module("validation.plots").hand_down()  # results draw themselves from now on
    return _explained(name, value) if isinstance(value, FunctionType) else value


def _explained(name: str, function: Any) -> Any:
    """Wrap a function: a call with wrong arguments explains the mistake, and every error is a typed one.

    The message names the wrong argument and the place where the value belongs.
    """
    import inspect

    signature = inspect.signature(function)

    @wraps(function)
    def call(*arguments: Any, **named: Any) -> Any:
        try:
            signature.bind(*arguments, **named)
        except TypeError as error:
            raise TypeError(f"spurcheck.{name}: {error}. {advice(str(error), named)}") from None
        from lumped.errors import typed_errors

        with typed_errors():
            return function(*arguments, **named)

    def advice(error: str, named: dict[str, Any]) -> str:
        word = next((key for key in named if key not in signature.parameters), "")
        if word in _ARGUMENTS:
            return _ARGUMENTS[word].format(name=name)
        if name == "new_pair" and "'module'" in error and "module" in named:
            return "The teeth are one text: spurcheck.new_pair('19/41', module=...)."
        if name == "plot" and "too many positional" in error:
            return "Several results are a list: spurcheck.plot([one, another])."
        if word and (words := _about_argument(name, word, named[word], list(signature.parameters))):
            return words
        missing = re.search(r"missing .*'(\w+)'", error)
        meaning = missing and re.search(rf"^ *({missing[1]} : .*)", inspect.getdoc(function) or "", re.M)
        takes = f"It takes {', '.join(signature.parameters)}"
        return f"{takes}; {meaning[1]}." if meaning else f"{takes}: see help(spurcheck.{name})."

    # pickle looks for the function by these names
    call.__module__ = __name__
    call.__qualname__ = name
    return call


def _about_argument(name: str, word: str, value: object, parameters: list[str]) -> str:
    """Advice on an argument that a function does not have; empty: there is none.

    Parameters
    ----------
    name : the function
    word : the argument
    value : its value
    parameters : arguments that the function has
    """
    import difflib

    from lumped.fields.hints import hint_of
    from lumped.schema.changes import SHORT_NAMES

    several = not isinstance(value, str) and hasattr(value, "__len__")
    plural = [one for one in parameters if one in (f"{word}s", f"{word}s_rpm")]
    near = (
        plural
        or [one for one in _SYNONYMS.get(word, ()) if one in parameters]
        or difflib.get_close_matches(word, [one for one in parameters if one != "pair"], 1, 0.8)
    )
    if "axes" in parameters and (several or not near) and (axis := _axis_for(word)):
        return f"Give an axis: spurcheck.{name}(pair, axes={{{axis!r}: [...]}})."
    if near:
        return f"The argument is {near[0]}: spurcheck.{name}(pair, {near[0]}=...)."
    if "pair" in parameters and (word in SHORT_NAMES or "__" in word):
        return f"Vary the pair: spurcheck.{name}(pair.with_({word}=...))."
    hint = hint_of(word)
    if "pair" in parameters and hint is not None:
        return f"Vary the pair: spurcheck.{name}(pair.with_({hint.arguments}))."
    return ""


def _axis_for(word: str) -> str:
    """The axis of a chart for a word; empty: there is none."""
    from floquet import GEAR_AXES

    starts = [axis for axis in GEAR_AXES if axis == word or axis.startswith(f"{word}_")]
    return starts[0] if starts else {"mu": "friction_coefficient", "zeta": "damping_ratio"}.get(word, "")


def _nearest(name: str) -> str:
    """Return a question that proposes names: names that contain ``name``, or else the most similar names."""
    import difflib

    for instead, words in _INSTEAD.items():
        if name.lower() in words.split():
            return f". Use {instead}"
    public_names = [*_NAMES, *(f"{one}.{other}" for one in _PACKAGES for other in import_module(one).__all__)]
    candidates = [one for one in public_names if name.lower() in one.lower()] or difflib.get_close_matches(
        name, public_names
    )
    return (
        f". Did you mean {' or '.join(f'spurcheck.{one}' for one in candidates[:3])}?" if candidates else ""
    )


def __getattr__(name: str) -> object:
    if name not in _NAMES:
        near = "" if name.startswith("_") else _nearest(name)
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}{near}")
    value = globals()[name] = _find(name)
    return value


def __dir__() -> list[str]:
    return sorted(_NAMES)


def _command() -> None:
    """Run the command ``spurcheck``."""
    from validation.cli import main

    main()


if __name__ == "__main__":
    _command()

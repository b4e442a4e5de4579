"""Can your lumped gear model be trusted? The main verbs of spurcheck under one name.

    import spurcheck

    pair = spurcheck.new_pair("19/41", module=2.5, face_width=20, speed=1450, torque=80)
    found = spurcheck.predict(pair)
    found.dynamic_factor, found.efficiency
    spurcheck.plot(found.cycle).savefig("motion.png")

Pairs      new_pair, load_gear_pair, preset_names, gear_pair_from_rexs; pair.with_(speed=2000) varies one
Motion     predict, dynamic_factor, steady_state, simulate, run_up, speed_sweep, response_branches,
           periodic_orbit
Gears      geometry, mesh_stiffness, natural_frequencies, static_transmission_error, optimal_relief, bodies
Trust      report, uncertainty, crosscheck, validity_flags, attribution, power_balance, compare_ross,
           compare_matrices
Stability  stability_chart, stability_margins, stability_boundaries, campbell
Any system PeriodicSystem, periodic_system, from_second_order, monodromy
Signals    order_spectrum, waterfall, time_synchronous_average; more in spurcheck.validation.signals
Studies    load_study, run_sweep, read_results
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
from types import FunctionType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import floquet
    import lumped
    import multibody
    import validation
    from floquet import (
        PeriodicSystem,
        campbell,
        from_second_order,
        monodromy,
        periodic_orbit,
        response_branches,
        stability_boundaries,
        stability_chart,
        stability_margins,
    )
    from lumped import (
        GearPair,
        LawRangeWarning,
        NumericalError,
        ParameterError,
        SpurcheckError,
        bodies,
        geometry,
        load_gear_pair,
        mesh_stiffness,
        natural_frequencies,
        optimal_relief,
        periodic_system,
        preset_names,
        run_up,
        simulate,
        speed_sweep,
        static_transmission_error,
        steady_state,
    )
    from multibody import attribution, power_balance
    from validation import (
        crosscheck,
        dynamic_factor,
        plot,
        predict,
        report,
        uncertainty,
        validity_flags,
        write_interactive_page,
    )
    from validation.exchange import (
        compare_matrices,
        compare_ross,
        gear_pair_from_rexs,
        new_pair,
        write_results,
        write_rexs,
    )
    from validation.signals import order_spectrum, time_synchronous_average, waterfall
    from validation.studies import load_study, read_results, run_sweep

    __version__: str

_PACKAGES = ("lumped", "multibody", "floquet", "validation")
#: Where a name is looked for, in this order; multibody, the slowest to import, comes last.
_SOURCES = (
    "lumped",
    "floquet",
    "validation",
    "validation.exchange",
    "validation.signals",
    "validation.studies",
    "multibody",
)

__all__ = [
    "GearPair",
    "LawRangeWarning",
    "NumericalError",
    "ParameterError",
    "PeriodicSystem",
    "SpurcheckError",
    "__version__",
    "attribution",
    "bodies",
    "campbell",
    "compare_matrices",
    "compare_ross",
    "crosscheck",
    "dynamic_factor",
    "floquet",
    "from_second_order",
    "gear_pair_from_rexs",
    "geometry",
    "load_gear_pair",
    "load_study",
    "lumped",
    "mesh_stiffness",
    "monodromy",
    "multibody",
    "natural_frequencies",
    "new_pair",
    "optimal_relief",
    "order_spectrum",
    "periodic_orbit",
    "periodic_system",
    "plot",
    "power_balance",
    "predict",
    "preset_names",
    "read_results",
    "report",
    "response_branches",
    "run_sweep",
    "run_up",
    "simulate",
    "speed_sweep",
    "stability_boundaries",
    "stability_chart",
    "stability_margins",
    "static_transmission_error",
    "steady_state",
    "time_synchronous_average",
    "uncertainty",
    "validation",
    "validity_flags",
    "waterfall",
    "write_interactive_page",
    "write_results",
    "write_rexs",
]

#: What to type instead of a name that no package has.
_INSTEAD = {
    "predict(pair).efficiency": "efficiency losses power_loss",
    "floquet.gear_pair_multipliers(pair).verdict": "is_stable stable",
    "order_spectrum(motion)": "fft spectrum",
    "preset_names()": "presets list_presets",
}
_NAMES = tuple(__all__)
__all__.clear()  # help() would print all that it names, 1,500 lines


def _find(name: str) -> object:
    if name == "__version__":
        return metadata.version("spurcheck")
    if name in _PACKAGES:
        return import_module(name)
    for source in _SOURCES:
        module = import_module(source)
        if name in module.__all__:
            value = getattr(module, name)
            return _explained(name, value) if isinstance(value, FunctionType) else value
    raise AssertionError(f"{name} is in no package")


def _explained(name: str, function: Any) -> Any:
    """The function; a call with arguments that it does not take says which, and where a value belongs."""
    import inspect

    signature = inspect.signature(function)

    @wraps(function)
    def call(*arguments: Any, **named: Any) -> Any:
        try:
            signature.bind(*arguments, **named)
        except TypeError as error:
            raise TypeError(f"spurcheck.{name}: {error}. {advice(str(error), named)}") from None
        return function(*arguments, **named)

    def advice(error: str, named: dict[str, Any]) -> str:
        from lumped.schema.changes import SHORT_NAMES

        word = next((key for key in named if key not in signature.parameters), "")
        if "pair" in signature.parameters and (word in SHORT_NAMES or "__" in word):
            return f"Vary the pair: spurcheck.{name}(pair.with_({word}=...))."
        if word == "model":
            return f"The multibody model is spurcheck.multibody.{name}."
        missing = re.search(r"missing .*'(\w+)'", error)
        meaning = missing and re.search(rf"^ *({missing[1]} : .*)", inspect.getdoc(function) or "", re.M)
        takes = f"It takes {', '.join(signature.parameters)}"
        return f"{takes}; {meaning[1]}." if meaning else f"{takes}: see help(spurcheck.{name})."

    call.__module__, call.__qualname__ = __name__, name  # where pickle finds it
    return call


def _nearest(name: str) -> str:
    """Ask whether names that contain this one, or the most similar one, were meant."""
    import difflib

    for instead, words in _INSTEAD.items():
        if name.lower() in words.split():
            return f". Use {instead}"
    known = [*_NAMES, *(f"{one}.{other}" for one in _PACKAGES for other in import_module(one).__all__)]
    close = [one for one in known if name.lower() in one.lower()] or difflib.get_close_matches(name, known)
    return f". Did you mean {' or '.join(f'spurcheck.{one}' for one in close[:3])}?" if close else ""


def __getattr__(name: str) -> object:
    if name not in _NAMES:
        near = "" if name.startswith("_") else _nearest(name)
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}{near}")
    value = globals()[name] = _find(name)
    return value


def __dir__() -> list[str]:
    return sorted(_NAMES)


if __name__ == "__main__":
    from validation.cli import main

    main()

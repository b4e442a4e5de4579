"""The main verbs of the four packages under one name, and the command as ``python -m spurcheck``.

    import spurcheck

    pair = spurcheck.load_gear_pair("nasa_28_28")
    spurcheck.steady_state(pair).attrs["mesh_efficiency"]

The packages are attributes too: ``spurcheck.lumped``, ``spurcheck.multibody``, ``spurcheck.floquet``,
``spurcheck.validation``. Where two packages have a function of the same name, the plain name is that of
`lumped` or `floquet`: `simulate`, `steady_state` and `speed_sweep` solve the lumped model, `monodromy` takes
a `PeriodicSystem`. Those of the multibody model are ``spurcheck.multibody.simulate`` and so on.

Everything is imported when it is first asked for: ``import spurcheck`` itself loads no package.
"""

from __future__ import annotations

from importlib import import_module, metadata
from typing import TYPE_CHECKING

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
        optimal_relief,
        periodic_system,
        preset_names,
        simulate,
        speed_sweep,
        static_transmission_error,
        steady_state,
    )
    from multibody import attribution, power_balance
    from validation import crosscheck, plot, report, uncertainty, validity_flags, write_interactive_page
    from validation.exchange import gear_pair_from_rexs, write_results, write_rexs
    from validation.studies import load_study, read_results, run_sweep

    __version__: str

_PACKAGES = ("lumped", "multibody", "floquet", "validation")
#: Where a name is looked for, in this order; multibody, the slowest to import, comes last.
_SOURCES = ("lumped", "floquet", "validation", "validation.exchange", "validation.studies", "multibody")

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
    "crosscheck",
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
    "optimal_relief",
    "periodic_system",
    "plot",
    "power_balance",
    "preset_names",
    "read_results",
    "report",
    "run_sweep",
    "simulate",
    "speed_sweep",
    "stability_boundaries",
    "stability_chart",
    "stability_margins",
    "static_transmission_error",
    "steady_state",
    "uncertainty",
    "validation",
    "validity_flags",
    "write_interactive_page",
    "write_results",
    "write_rexs",
]


def _find(name: str) -> object:
    if name == "__version__":
        return metadata.version("spurcheck")
    if name in _PACKAGES:
        return import_module(name)
    for source in _SOURCES:
        module = import_module(source)
        if name in module.__all__:
            return getattr(module, name)
    raise AssertionError(f"{name} is in no package")


def __getattr__(name: str) -> object:
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = globals()[name] = _find(name)
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})


if __name__ == "__main__":
    from validation.cli import main

    main()

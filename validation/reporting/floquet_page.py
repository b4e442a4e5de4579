"""The computed parts of docs/verification/floquet.md, and the page filled with them.

    python -m validation.reporting.floquet_page docs/verification/floquet.md OUT

writes OUT/floquet.md with every number in its place, and the figure beside it. The documentation site
includes the same parts, `FILES`.
"""

from __future__ import annotations

import math
import re
import sys
import tempfile
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

from floquet.gear.coulomb_zones import zones
from floquet.gear.vaishya_singh import CoulombGearPair
from lumped.errors import NumericalError, refuse
from validation.files.output import write_text
from validation.plots.style import save
from validation.plots.tongues import zones_figure
from validation.reporting.formatting import number
from validation.verification import floquet_closed_forms as checks
from validation.verification.coulomb_zones import MU, check_coulomb_gear_pair, zone_tips
from validation.verification.floquet_check import Check
from validation.verification.random_gears import check_random_gears

_INCLUDE = re.compile(r"```\{include\} (?:\.\./)?_generated/(\S+)\n```")
_FIGURE = re.compile(r"```\{figure\} (?:\.\./)?_generated/(\S+)\n:alt: (.*)\n```")


def check_table(functions: Sequence[Callable[[], Iterable[Check]]]) -> str:
    """Markdown table of all numbers of some checks.

    Raises
    ------
    NumericalError : a number is outside its bounds
    """
    rows = []
    for function in functions:
        for check in function():
            if not check.passed:
                raise NumericalError(
                    f"{check.name}: {check.value:.3g} is not {check.wanted}. Run the tests of the engine."
                )
            rows.append((check.name, number(check.value, 3), check.wanted, check.meaning))
    return _table(("check", "number", "must be", "meaning"), rows)


def exact() -> str:
    """Closed forms and invariants."""
    return check_table(
        (
            checks.check_meissner,
            checks.check_mathieu,
            checks.check_constant_coefficients,
            checks.check_invariants,
        )
    )


def orders() -> str:
    """Orders of convergence."""
    return check_table((checks.check_orders,))


def combinations() -> str:
    """Combination resonances."""
    return check_table((checks.check_hsu, checks.check_gear_chain))


def coulomb() -> str:
    """The pair with one degree of freedom and Coulomb friction."""
    return check_table((check_coulomb_gear_pair,))


def coulomb_tips() -> str:
    """Where its zones close."""
    names = {"none": "no friction", "reversing": "reversing", "constant": "of one sign"}
    rows = [
        (zone, names[case], number(damping, 4), number(ratio, 4))
        for zone, case, damping, ratio in zone_tips()
    ]
    pair = CoulombGearPair(friction=MU)
    angle = math.degrees(pair.pressure_angle)
    head = f"μ = {MU:g}, contact ratio {pair.contact_ratio:g}, pressure angle {angle:g}°:\n\n"
    return head + _table(
        ("zone", "friction", "closed by damping ratio", "at mesh over natural frequency"), rows
    )


def coulomb_zones() -> str:
    """Figure of its zones, as SVG."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "zones.svg"
        save(zones_figure(zones(CoulombGearPair(friction=MU))), path)
        return path.read_text(encoding="utf-8")


def random_gears() -> str:
    """Stress test on random gear pairs."""
    return check_table((check_random_gears,))


FILES: dict[str, Callable[[], str]] = {
    "floquet_exact.md": exact,
    "floquet_orders.md": orders,
    "floquet_combinations.md": combinations,
    "floquet_coulomb.md": coulomb,
    "floquet_coulomb_tips.md": coulomb_tips,
    "floquet_coulomb_zones.svg": coulomb_zones,
    "floquet_random_gears.md": random_gears,
}
"""Name of a part -> what writes it."""


def filled(text: str) -> tuple[str, dict[str, str]]:
    """Put the computed parts into the text of the page.

    Parameters
    ----------
    text : Markdown that includes ``_generated/<part>``, parts as in `FILES`

    Returns
    -------
    the page, and the figures that belong beside it: name -> text

    Raises
    ------
    ParameterError : the text asks for an unknown part
    NumericalError : a number is outside its bounds
    """
    figures = {name: _part(name) for name, _ in _FIGURE.findall(text)}
    page = _FIGURE.sub(lambda found: f"![{found[2]}]({found[1]})", text)
    return _INCLUDE.sub(lambda found: _part(found[1]).rstrip("\n"), page), figures


def _part(name: str) -> str:
    if name not in FILES:
        raise refuse("included part", name, ", ".join(FILES), "Correct the page.")
    return FILES[name]()


def _table(columns: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    lines = [columns, ["---"] * len(columns), *([cell.replace("|", "\\|") for cell in row] for row in rows)]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines) + "\n"


def main(arguments: Sequence[str]) -> int:
    """Write the page; return the exit code."""
    if len(arguments) != 2:
        print("usage: python -m validation.reporting.floquet_page PAGE.md FOLDER", file=sys.stderr)
        return 2
    source, folder = map(Path, arguments)
    page, figures = filled(source.read_text(encoding="utf-8"))
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in (*figures.items(), (source.name, page)):
        write_text(folder / name, text)
    return 0


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))

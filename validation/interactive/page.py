"""The interactive page as one HTML file that needs no network, and the data file beside it."""

from __future__ import annotations

import base64
import hashlib
from importlib.resources import files
from pathlib import Path

import numpy as np
from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from floquet.gear.axes import operating_rpm
from lumped import GearPair, load_gear_pair
from lumped.arguments import file_path, of_type
from lumped.display.progress import reported_to, shows_progress
from lumped.errors import refuse
from lumped.friction.registry import law_of
from lumped.model.periodic_system import Supports, on_springs
from lumped.typing import ProgressRequest
from validation.files.output import write_dataset, write_text
from validation.interactive.payload import payload, script_json
from validation.interactive.results import FINE, PageResults, Sampling, compute

#: Parts of the page's own script, in this order.
_SCRIPTS = ("data.js", "chart.js", "stability.js", "sweep.js", "start.js")


@shows_progress("interactive page")
def write_interactive_page(
    pair: GearPair | str | Path,
    path: str | Path,
    *,
    data: str | Path | None = None,
    new: bool = False,
    sampling: Sampling = FINE,
    supports: Supports | None = None,
    progress: ProgressRequest = None,
) -> Path:
    """Write the interactive page of a gear pair and, as NetCDF, every number on it.

    Parameters
    ----------
    pair : gear pair, preset name or parameter file; all teeth of a gear are taken as alike
    path : the page, ``.html``
    data : the data file, ``.nc``; default: file with the name of the page, in the folder of the page
    new : if true, existing files of these names are not replaced
    sampling : numbers of points of charts and responses
    supports : "springs", the only supports of this computation; needed for a pair with shafts
    progress : True (a bar), False (none), None (a bar where the call takes over two seconds), or a function
        that is called with the finished fraction and what is being done

    Returns
    -------
    path of the page

    Raises
    ------
    ParameterError : a refused parameter, or shafts
    NumericalError : a computation fails; the text says what to try
    StorageError : a file cannot be written, or with ``new`` is there already
    """
    progress = reported_to(progress)
    pair = on_springs(load_gear_pair(pair), supports, "write_interactive_page").healthy
    of_type("sampling", sampling, Sampling, "a Sampling")
    page = file_path("path", path)
    values = page.with_suffix(".nc") if data is None else file_path("data", data)
    results = compute(pair, sampling, progress)
    write_dataset(results.dataset(), values, new=new)
    write_text(page, render(results, values.name), new=new)
    return page


def render(results: PageResults, data_name: str) -> str:
    """Return the page as text.

    The security policy of the page names the scripts of the page by hashes: no other script may run or load.

    ``data_name``: name of the data file; the text mentions this name.
    """
    environment = Environment(
        loader=PackageLoader("validation.interactive", "templates"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    folder = files("validation.interactive") / "templates"
    page_script = "\n".join((folder / name).read_text(encoding="utf-8") for name in _SCRIPTS)
    scripts = [plotly(), f'(() => {{\n"use strict";\n{page_script}}})();']
    pair = results.pair
    return environment.get_template("page.html").render(
        pair=pair,
        rpm=operating_rpm(pair),
        law=law_of(pair.friction).title,
        multipliers=results.multipliers,
        step=float(np.diff(next(iter(results.stability.values())).chart["speed_rpm"]).max()),
        missing={law_of(pair.friction, law).title: reason for law, reason in results.missing.items()},
        data_name=data_name,
        policy="script-src " + " ".join(map(_hash, scripts)),
        scripts=[Markup(_safe(script)) for script in scripts],
        css=Markup((folder / "page.css").read_text(encoding="utf-8")),
        json=Markup(script_json(payload(results))),
    )


def plotly() -> str:
    """Return the script of Plotly from the installed package. The package is optional."""
    try:
        package = files("plotly")
    except ModuleNotFoundError:
        action = 'Install it: pip install "spurcheck[interactive]".'
        raise refuse("plotly", "missing", "the package that draws the page", action) from None
    return (package / "package_data" / "plotly.min.js").read_text(encoding="utf-8")


def _hash(script: str) -> str:
    digest = hashlib.sha256(script.encode("utf-8")).digest()
    return f"'sha256-{base64.b64encode(digest).decode('ascii')}'"


def _safe(script: str) -> str:
    """Return the script after a check that no text in the script ends the script element."""
    lower = script.lower()
    if "</script" in lower or "<!--" in lower:
        raise ValueError("a script holds text that would end its element")
    return script

"""Write a reference case into a folder: statement, parameter file, curves, licence and figure."""

from __future__ import annotations

from pathlib import Path

from lumped.errors import refuse
from validation.files.output import not_writable, write_text
from validation.plots.style import save
from validation.reference_cases.case import ReferenceCase
from validation.reference_cases.files import LICENCE_FILE, case_file, checked_text, curves_file, pair_file


def write_case(case: ReferenceCase, folder: Path, *, force: bool = False) -> list[Path]:
    """Write the files of a case and its figure.

    Parameters
    ----------
    case : a reference case
    folder : made if it does not exist
    force : whether files of the same names are replaced

    Returns
    -------
    the files that were written

    Raises
    ------
    ParameterError : a file exists and ``force`` is not set, or the folder cannot be written
    StorageError : writing failed
    """
    names = [case_file(case.name), curves_file(case.name), LICENCE_FILE]
    if case.pair is not None:
        names.insert(0, pair_file(case.name))
    figure = f"{case.name}.svg"
    for name in (*names, figure):
        if (folder / name).exists() and not force:
            action = "It exists: choose another folder, or give --force."
            raise refuse("output", folder / name, "a new file", action)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise not_writable(folder, error) from None
    for name in names:
        write_text(folder / name, checked_text(name), new=not force)
    save(case.plot(), folder / figure, new=not force)
    return [folder / name for name in (*names, figure)]

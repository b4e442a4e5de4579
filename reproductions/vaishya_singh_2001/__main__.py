"""Judge the statements again: ``python -m reproductions.vaishya_singh_2001 [FOLDER]``.

Writes ``statements.json`` and the pictures (SVG, PNG).
"""

from __future__ import annotations

import json
import sys
from dataclasses import asdict
from pathlib import Path

from reproductions.vaishya_singh_2001.judge import statements
from reproductions.vaishya_singh_2001.plots import DRAW
from validation.plots.style import save


def main(folder: Path) -> None:
    """Write everything into a folder, which may exist."""
    (folder / "pictures").mkdir(parents=True, exist_ok=True)
    for name, draw in DRAW.items():
        figure = draw()
        save(figure, folder / f"{name}.svg")
        figure.savefig(folder / "pictures" / f"{name}.png", dpi=72, metadata={"Software": None})
    table = statements()
    text = json.dumps([asdict(one) for one in table], indent=1) + "\n"
    (folder / "statements.json").write_text(text, encoding="utf-8")
    for one in table:
        values = ", ".join(f"{value:.3g}" for value in one.values.values())
        print(f"{one.rule.name}: {values} {one.rule.unit}: {one.verdict}")
    print(f"{sum(one.verdict == 'reproduced' for one in table)} statements reproduced: {folder}")


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "build/reproductions/vaishya_singh_2001"))

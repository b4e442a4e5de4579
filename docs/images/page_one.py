"""Make ``report_page_one.png``, the first page of a report, for the first page of the documentation.

    python docs/images/page_one.py [REPORT/index.html]

Without an argument it takes the report that ``make docs`` wrote. It needs Chromium, so the picture is stored:
make the picture again when page 1 changes.
"""

import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from PIL import Image

HERE = Path(__file__).resolve().parent
BUILT = HERE.parents[1] / "build" / "docs" / "report" / "index.html"
#: Size of the window [px], pixels of the picture for each, and number of colours of the stored picture.
WIDTH = 1000
HEIGHT = 1105
SCALE = 1.5
COLOURS = 48


def main(report: Path) -> None:
    """Photograph the head of a report."""
    browser = next(filter(None, map(shutil.which, ("chromium", "google-chrome", "chromium-browser"))), None)
    if browser is None:
        raise SystemExit("No Chromium or Chrome on PATH: install one.")
    with tempfile.TemporaryDirectory() as folder:
        photograph = Path(folder) / "page.png"
        options = ("--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars")
        size = (f"--window-size={WIDTH},{HEIGHT}", f"--force-device-scale-factor={SCALE}")
        command = [browser, *options, *size, f"--screenshot={photograph}", report.resolve().as_uri()]
        subprocess.run(command, check=True, capture_output=True)
        picture = Image.open(photograph).convert("RGB").quantize(COLOURS)
        picture.save(HERE / "report_page_one.png", optimize=True)


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else BUILT)

"""A page with names that attack it, and a real Chromium to open it in."""

import json
import shutil
import time
from pathlib import Path

import pytest
import xarray as xr

import lumped
from validation.interactive import write_interactive_page
from validation.interactive.results import Sampling

#: Ends a script element, opens elements, breaks attributes, JSON and templates, and has no ASCII.
HOSTILE = (
    "</script><script>document.title='owned'</script><img src=x onerror=alert(1)>",
    "</style></title></noscript><script>document.title='owned'</script>"
    "<img src=x onerror=\"document.title='owned'\">{{ 7*7 }} \u2028 Zahnrad & Söhne <!--<script>",
)
SAMPLING = Sampling(speeds=31, dampings=6, slices=3, sweep_speeds=9)
WIDE = (1280, 900)
PHONE = (390, 844)


@pytest.fixture(scope="session")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("interactive")


@pytest.fixture(scope="session")
def pair():
    """Little damping, so that unstable speeds are on the page."""
    return lumped.load_gear_pair("nasa_28_28").with_(
        {"mesh.damping_ratio": 0.016, "operating.speed_range": "1050..21000"}
    )


@pytest.fixture(scope="session")
def written(pair, folder):
    return write_interactive_page(pair, folder / "pair.html", sampling=SAMPLING)


@pytest.fixture(scope="session")
def data(written):
    with xr.open_dataset(written.with_suffix(".nc")) as dataset:
        return dataset.load()


@pytest.fixture(scope="session")
def attack():
    """Name and description."""
    return HOSTILE


@pytest.fixture(scope="session")
def hostile(pair, folder, attack):
    """The page of a pair whose name and description are an attack."""
    attacked = pair.with_(dict(zip(("name", "description"), attack, strict=True)))
    sampling = Sampling(speeds=5, dampings=2, slices=2, sweep_speeds=3)
    return write_interactive_page(attacked, folder / "hostile.html", sampling=sampling)


def _programs():
    browser = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
    return browser, shutil.which("chromedriver")


class Browser:
    """One tab of Chromium."""

    def __init__(self, driver):
        self.driver = driver
        self.run = driver.execute_script
        self.shown = None

    def open(self, path, size=(1280, 900), *, dark=False, scripts=True):
        """Open a page in a window of this size, and wait until its charts are drawn."""
        self.shown = None
        command = self.driver.execute_cdp_cmd
        command("Emulation.setScriptExecutionDisabled", {"value": not scripts})
        narrow = size[0] < 600
        metrics = {"width": size[0], "height": size[1], "deviceScaleFactor": 1, "mobile": narrow}
        command("Emulation.setDeviceMetricsOverride", metrics)
        scheme = {"name": "prefers-color-scheme", "value": "dark" if dark else "light"}
        command("Emulation.setEmulatedMedia", {"features": [scheme]})
        self.console(), self.requests()  # what earlier pages left
        self.driver.get(Path(path).as_uri())
        if scripts:
            self.wait("document.documentElement.dataset.ready === 'yes'")
        return self

    def keep(self, path):
        """Open a page unless the last test kept it; for tests that set what they look at and do not zoom."""
        if self.shown != path:
            self.open(path)
            self.shown = path
        return self

    def wait(self, condition, seconds=60):
        """Wait until an expression is true in the page; other work may slow the machine down."""
        end = time.monotonic() + seconds
        while not self.run(f"return Boolean({condition})"):
            assert time.monotonic() < end, condition
            time.sleep(0.05)

    def console(self):
        return [f"{entry['level']}: {entry['message']}" for entry in self.driver.get_log("browser")]

    def requests(self):
        """Addresses that the page asked for since the last call."""
        events = [json.loads(entry["message"])["message"] for entry in self.driver.get_log("performance")]
        return [e["params"]["request"]["url"] for e in events if e["method"] == "Network.requestWillBeSent"]

    def text(self, name):
        return self.run("return document.getElementById(arguments[0]).textContent", name)

    def press(self, *keys):
        """Press keys, one after the other, wherever the focus is."""
        for key in keys:
            self.driver.switch_to.active_element.send_keys(key)

    def focus(self, name):
        self.run("document.getElementById(arguments[0]).focus()", name)

    def choose(self, name, value):
        """Set a native control as its user would."""
        self.run(
            "const e = document.getElementById(arguments[0]); e.value = arguments[1];"
            "e.dispatchEvent(new Event('input')); e.dispatchEvent(new Event('change'));",
            name,
            str(value),
        )

    def drawn(self, plot, script):
        """Value of an expression of ``plot`` after what was asked for is drawn."""
        return self.driver.execute_async_script(
            f"const done = arguments[0], plot = document.getElementById('{plot}');"
            f"requestAnimationFrame(() => requestAnimationFrame(() => done(({script}))));"
        )

    def mouse(self, event, x, y, **more):
        self.driver.execute_cdp_cmd("Input.dispatchMouseEvent", {"type": event, "x": x, "y": y, **more})

    def click(self):
        """Click where the mouse hovers."""
        for event in ("mousePressed", "mouseReleased"):
            self.mouse(event, *self.place, button="left", clickCount=1)

    def hover(self, plot, x, y, y_axis="yaxis"):
        """Lines of the label that appears when the mouse stands on a place of a chart."""
        place = self.run(
            "const plot = document.getElementById(arguments[0]);"
            "plot.scrollIntoView({block: 'center'});"
            "const l = plot._fullLayout, box = plot.getBoundingClientRect(), y = l[arguments[3]];"
            "return [box.left + l.xaxis._offset + l.xaxis.d2p(arguments[1]),"
            "        box.top + y._offset + y.d2p(arguments[2])];",
            plot, x, y, y_axis,
        )  # fmt: skip
        self.mouse("mouseMoved", 1, 1)
        label = f"document.querySelector('#{plot} .hoverlayer .hovertext')"
        self.wait(f"!{label}")
        self.place = place
        self.mouse("mouseMoved", *place)
        self.wait(label)
        lines = f"{label}.querySelectorAll('tspan.line')"
        return self.run(f"return Array.from({lines}, line => line.textContent)")


@pytest.fixture(scope="session")
def browser(tmp_path_factory):
    binary, driver_path = _programs()
    if binary is None or driver_path is None:
        pytest.skip("needs Chromium and chromedriver on the path (Debian: chromium, chromium-driver)")
    webdriver = pytest.importorskip("selenium.webdriver", reason="needs selenium (extra: test)")
    from selenium.common.exceptions import WebDriverException

    options = webdriver.ChromeOptions()
    options.binary_location = binary
    profile = tmp_path_factory.mktemp("profile")
    for argument in (
        "headless=new", "no-sandbox", "disable-dev-shm-usage", "disable-gpu", "no-first-run",
        "disable-background-networking", f"user-data-dir={profile}",
    ):  # fmt: skip
        options.add_argument(f"--{argument}")
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    try:
        driver = webdriver.Chrome(options=options, service=webdriver.ChromeService(driver_path))
    except WebDriverException as error:  # a browser that the machine has but cannot start
        pytest.skip(f"Chromium does not start: {error.msg}")
    driver.set_script_timeout(60)
    yield Browser(driver)
    driver.quit()

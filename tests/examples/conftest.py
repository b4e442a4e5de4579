"""Load an example by its number."""

import importlib.util
from pathlib import Path
from types import ModuleType

import pytest

FOLDER = Path(__file__).resolve().parents[2] / "examples"


@pytest.fixture
def example():
    def load(number: int) -> ModuleType:
        (path,) = FOLDER.glob(f"{number:02d}_*.py")
        assert len(path.read_text().splitlines()) < 100, "an example is read in one sitting"
        spec = importlib.util.spec_from_file_location(path.stem, path)
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        return module

    return load


@pytest.fixture
def labelled():
    def check(figure):
        for axes in figure.axes:
            assert axes.get_xlabel() or axes.get_label() == "<colorbar>"
            assert axes.get_ylabel()

    return check


@pytest.fixture
def shown(example, labelled):
    """The module and the result of an example whose figure has labelled axes."""

    def show(number: int):
        module = example(number)
        result = module.compute()
        labelled(module.draw(result))
        return module, result

    return show

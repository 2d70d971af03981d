"""Fixtures shared by all tests."""

import os
from collections.abc import Callable
from pathlib import Path
from typing import NoReturn

import pytest

# Two workers with two threads each would wait for one another on two cores. Set before torch is imported.
os.environ.setdefault("OMP_NUM_THREADS", "1")


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Files with the longest tests first: a worker that begins with one at the end keeps the other."""
    long = {
        item.path
        for item in items
        if item.get_closest_marker("real_data") and item.get_closest_marker("slow")
    }
    items.sort(key=lambda item: item.path not in long)


@pytest.fixture(scope="session")
def data_dir() -> Path:
    """Folder of the real sets, from HORIZON_DL_DATA; tests that ask for it skip without it."""
    folder = os.environ.get("HORIZON_DL_DATA")
    if not folder:
        pytest.skip("HORIZON_DL_DATA is not set")
    return Path(folder)


@pytest.fixture(scope="session")
def no_network() -> Callable[[str], NoReturn]:
    """Ends a test that could not reach a registry: it skips, but fails where the whole suite is asked for."""

    def end(problem: str) -> NoReturn:
        if os.environ.get("HORIZON_DL_DATA"):
            pytest.fail(problem)
        pytest.skip(problem)

    return end


@pytest.fixture(scope="session")
def model():
    """The export of the small run, loaded."""
    from small_run import model_file

    from horizon_dl.runtime.model import ObstacleModel

    return ObstacleModel.load(model_file())


@pytest.fixture
def trusting(monkeypatch: pytest.MonkeyPatch) -> None:
    """Flights believe every frame: for models that look at no picture."""
    from flat_model import TrustingJudge

    monkeypatch.setattr("horizon_dl.runtime.perception.Judge", TrustingJudge)

"""Fixtures shared by all tests."""

import os
from pathlib import Path

import pytest


@pytest.fixture(scope="session")
def data_dir() -> Path:
    """Folder of the real sets, from HORIZON_DL_DATA; tests that ask for it skip without it."""
    folder = os.environ.get("HORIZON_DL_DATA")
    if not folder:
        pytest.skip("HORIZON_DL_DATA is not set")
    return Path(folder)

"""A headless Chromium for tests of pages; without one the tests are skipped."""

import shutil
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import pytest

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")


@contextmanager
def browser_page(width: int = 1400, height: int = 900, dark: bool = False) -> Iterator[Any]:
    """A page of a fresh browser; what its console says stands in `page.complaints`."""
    playwright = pytest.importorskip("playwright.sync_api")
    if CHROMIUM is None:
        pytest.skip("no Chromium on this machine")
    with playwright.sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox", "--disable-gpu"])
        page = browser.new_page(
            viewport={"width": width, "height": height}, color_scheme="dark" if dark else "light"
        )
        page.set_default_timeout(60_000)
        page.complaints = []
        page.on("console", lambda m: page.complaints.append(m.text) if m.type == "error" else None)
        page.on("pageerror", lambda error: page.complaints.append(str(error)))
        yield page
        browser.close()


def until(page: Any, expression: str, seconds: float = 60.0) -> None:
    """Wait until an expression is true; the browser's own way needs `eval`, which the pages forbid."""
    end_s = time.monotonic() + seconds
    while not page.evaluate(expression):
        assert time.monotonic() < end_s, f"never true: {expression}"
        time.sleep(0.05)

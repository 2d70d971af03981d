"""The pages look as they were last looked at: small grey screenshots, held against stored ones.

The stored pictures are a sixteenth as large, so that fonts may differ between machines: what is compared is
where things stand, how dark they are, and how large. Where a page is meant to look otherwise, look at it, and

    HORIZON_DL_KEEP_SCREENSHOTS=1 pytest tests/test_screenshots.py
"""

import io
import os
from pathlib import Path

import numpy as np
import pytest
from browser import browser_page
from made_up_report import write_page_of_scenes, write_report_of_scenes
from PIL import Image

FOLDER = Path(__file__).with_name("screenshots")
SMALLER = 16
MOST_MEAN, MOST_OFF = 6.0, 0.06
"""Grey levels between two pictures in the mean, and the share of pixels that may differ by over 40."""

WRITERS = {"report": write_report_of_scenes, "run": lambda folder: write_page_of_scenes(folder, 6)}


@pytest.fixture(scope="module")
def pages(tmp_path_factory) -> dict[str, Path]:
    return {name: write(tmp_path_factory.mktemp(name)) for name, write in WRITERS.items()}


def small(screenshot: bytes) -> Image.Image:
    picture = Image.open(io.BytesIO(screenshot)).convert("L")
    return picture.resize((picture.width // SMALLER, picture.height // SMALLER), Image.Resampling.BOX)


def unlike(one: Image.Image, other: Image.Image) -> tuple[float, float]:
    """Mean difference of grey levels, and the share of pixels that differ by over 40."""
    off = np.abs(np.asarray(one, np.float64) - np.asarray(other, np.float64))
    return float(off.mean()), float((off > 40).mean())


@pytest.mark.parametrize("dark", [False, True], ids=["light", "dark"])
@pytest.mark.parametrize("width", [390, 1400])
@pytest.mark.parametrize("name", sorted(WRITERS))
def test_it_looks_as_it_did(pages, name, width, dark):
    with browser_page(width, 900, dark) as page:
        page.goto(pages[name].as_uri())
        page.wait_for_selector("[data-cell=map] canvas")
        page.wait_for_timeout(300)
        found = small(page.screenshot())
    stored = FOLDER / f"{name}-{width}-{'dark' if dark else 'light'}.png"
    if os.environ.get("HORIZON_DL_KEEP_SCREENSHOTS"):
        FOLDER.mkdir(exist_ok=True)
        found.save(stored, optimize=True)
    mean, off = unlike(found, Image.open(stored))
    assert mean < MOST_MEAN, f"{mean:.1f} grey levels"
    assert off < MOST_OFF, f"{off:.0%} of the page"


def test_a_page_that_lost_its_pictures_or_its_night_is_told_apart():
    """Or the comparison would be worth nothing."""
    day, night = (Image.open(FOLDER / f"report-1400-{name}.png") for name in ("light", "dark"))
    assert unlike(day, night)[0] > 10 * MOST_MEAN
    empty = Image.new("L", day.size, int(np.median(np.asarray(day))))
    assert unlike(day, empty)[1] > MOST_OFF
    moved = Image.fromarray(np.roll(np.asarray(day), 4, axis=0))
    assert unlike(day, moved)[1] > MOST_OFF

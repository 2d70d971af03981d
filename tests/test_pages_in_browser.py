"""The report and the run's page in a headless Chromium: slider, keys, hover, phone, dark mode, no errors."""

from pathlib import Path

import pytest
from browser import browser_page, until
from made_up_report import FRAMES, write_page_of_scenes, write_report_of_scenes

OBSTACLE_PIXELS = """() => {
  const canvas = document.querySelector('[data-cell=map] canvas'), data = canvas.getContext('2d')
    .getImageData(0, 0, canvas.width, canvas.height).data;
  let count = 0;
  for (let i = 0; i < data.length; i += 4) count += data[i] > 150 && data[i + 1] < 130 && data[i + 2] < 90;
  return count;
}"""
ROC_MARK = "document.querySelector('[data-chart=roc] .mark circle').getAttribute('cx')"
# Relative luminance as WCAG has it, of text against the page's ground.
CONTRAST = """() => {
  const light = (text) => {
    const [r, g, b] = text.match(/[\\d.]+/g).slice(0, 3).map((v) => v / 255)
      .map((v) => v <= 0.03928 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4);
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  const ground = light(getComputedStyle(document.body).backgroundColor);
  return Math.min(...['p', 'figcaption', 'a', 'th', 'td', 'dt', '.hint', '#rates'].map((name) => {
    const ink = light(getComputedStyle(document.querySelector(name)).color);
    return (Math.max(ink, ground) + 0.05) / (Math.min(ink, ground) + 0.05);
  }));
}"""
UNNAMED = """() => [...document.querySelectorAll('img, canvas, svg, input, select, button')].filter((e) =>
  !e.closest('[hidden]') && !(e.getAttribute('alt') || e.getAttribute('aria-label') || e.textContent.trim()
    || (e.id && document.querySelector(`label[for=${e.id}]`)) || e.closest('label')))
  .map((e) => e.outerHTML)"""


@pytest.fixture(scope="module")
def report(tmp_path_factory) -> Path:
    return write_report_of_scenes(tmp_path_factory.mktemp("report"))


def opened(page, path: Path) -> None:
    page.goto(path.as_uri())
    page.wait_for_selector("[data-cell=map] canvas")


def test_the_threshold_moves_map_rates_and_roc_together(report):
    with browser_page() as page:
        opened(page, report)
        before = page.evaluate(OBSTACLE_PIXELS), page.inner_text("#rates"), page.evaluate(ROC_MARK)
        page.focus("#threshold")
        page.keyboard.press("Home")
        low = page.evaluate(OBSTACLE_PIXELS), page.inner_text("#rates"), page.evaluate(ROC_MARK)
        page.keyboard.press("End")
        high = page.evaluate(OBSTACLE_PIXELS), page.inner_text("#rates"), page.evaluate(ROC_MARK)
        assert low[0] > before[0] > high[0]
        assert len({one[1] for one in (before, low, high)}) == 3
        assert float(low[2]) > float(before[2]) >= float(high[2])
        page.click("#own-threshold")
        assert page.inner_text("#rates") == before[1]
        page.select_option("#method", "rf")
        until(page, "document.getElementById('threshold-value').textContent === '0.600'")
        assert page.complaints == []


def test_frames_by_key_and_the_worst_first(report):
    with browser_page() as page:
        opened(page, report)
        assert page.inner_text("#frame-title").startswith(f"1 of {FRAMES}: cam/000.png")
        page.keyboard.press("ArrowRight")
        until(page, "document.getElementById('frame-title').textContent.includes('cam/001.png')")
        page.keyboard.press("ArrowLeft")
        page.keyboard.press("ArrowLeft")  # the first has none before it
        until(page, "document.getElementById('frame-title').textContent.startsWith('1 of')")
        page.select_option("#order", "ten")
        until(page, "document.getElementById('frame-title').textContent.startsWith('1 of 10')")
        aucs = page.evaluate(
            "JSON.parse(document.getElementById('data').textContent).browser.frames.map(f => f.maps.cnn.auc)"
        )
        assert f"AUC of this frame {min(aucs):.3f}" in page.inner_text("#frame-title")
        page.click("[data-cell=map] canvas")
        assert page.is_visible("#large canvas")
        page.keyboard.press("Escape")
        assert page.complaints == []


def test_charts_tell_their_values_to_pointer_and_keys(report):
    with browser_page() as page:
        opened(page, report)
        for name in ("roc", "auc"):
            chart = page.locator(f"[data-chart={name}] svg")
            chart.scroll_into_view_if_needed()
            chart.hover(position={"x": 200, "y": 150})
            words = page.inner_text(f"[data-chart={name}] .tip")
            assert "CNN" in words or "forest" in words or "position" in words
        page.focus("[data-chart=roc] svg")
        page.keyboard.press("ArrowRight")
        first = page.inner_text("[data-chart=roc] .tip")
        page.keyboard.press("ArrowRight")
        assert "threshold" in first
        assert page.inner_text("[data-chart=roc] .tip") != first
        assert page.inner_text("#frame-title").startswith("1 of")  # the same keys leave the frames alone here


@pytest.mark.parametrize("dark", [False, True])
@pytest.mark.parametrize("width", [390, 1400])
def test_readable_on_every_screen(report, width, dark):
    with browser_page(width, dark=dark) as page:
        opened(page, report)
        assert page.evaluate("document.documentElement.scrollWidth") <= width
        assert page.evaluate(CONTRAST) >= 4.5
        assert page.evaluate(UNNAMED) == []
        ground = page.evaluate("getComputedStyle(document.body).backgroundColor")
        assert (ground == "rgb(22, 24, 28)") == dark
        assert page.complaints == []


def test_it_is_one_file_that_asks_nobody(report, tmp_path):
    alone = tmp_path / "mailed.html"
    alone.write_bytes(report.read_bytes())
    with browser_page() as page:
        asked = []
        page.on("request", lambda request: asked.append(request.url))
        opened(page, alone)
        others = [url for url in asked if not url.startswith(("data:", alone.as_uri()))]
        assert all(url.endswith("/film.mp4") for url in others)
        until(page, "!document.querySelector('video') || document.querySelector('figure.film').hidden")


def test_a_film_that_was_missed_before_the_script_ran_is_left_out_as_well(report, tmp_path):
    alone = tmp_path / "mailed.html"
    alone.write_bytes(report.read_bytes())
    before = """Object.defineProperty(HTMLMediaElement.prototype, "error", {get: () => ({code: 4})});
        HTMLMediaElement.prototype.addEventListener = () => {};"""
    with browser_page() as page:
        page.add_init_script(before)
        opened(page, alone)
        assert page.evaluate("document.querySelector('video') !== null")
        until(page, "document.querySelector('figure.film').hidden", seconds=10)


def test_a_film_beside_the_page_plays(report):
    with browser_page() as page:
        opened(page, report)
        film = "document.querySelector('video')"
        if page.evaluate(f"{film}.canPlayType('video/mp4; codecs=\"avc1.42E01E\"')") == "":
            pytest.skip("this Chromium plays no H.264")
        until(page, f"{film}.readyState >= 1")
        assert page.evaluate(f"{film}.videoWidth") > 1000
        assert page.evaluate(f"{film}.duration") == pytest.approx(0.2 * (FRAMES - 1), abs=0.5)


def test_a_run_of_many_frames_keeps_a_bounded_number(tmp_path):
    path = write_page_of_scenes(tmp_path, 70)
    assert path.stat().st_size < 6_000_000
    with browser_page() as page:
        opened(page, path)
        count = int(page.inner_text("#frame-title").split(" of ")[1].split(":")[0])
        assert 12 <= count <= 34
        page.keyboard.press("ArrowRight")
        assert page.complaints == []


def test_a_frames_name_cannot_become_part_of_the_page(tmp_path):
    nasty = '</script><img src=x onerror="document.title=1">'
    path = write_page_of_scenes(tmp_path, 2, lambda one: type(one)(**{**vars(one), "name": nasty}))
    with browser_page() as page:
        opened(page, path)
        assert nasty in page.inner_text("#frame-title")
        assert page.title() == "A run"
        assert page.complaints == []

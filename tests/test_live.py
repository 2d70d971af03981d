"""What can be watched while it runs: the live page, and what flights and online runs leave."""

import json
import socket
import threading
import time
import urllib.error
import urllib.request
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from browser import browser_page, until
from scene import scene
from test_film import REFERENCE, part_of_the_embedded_flight, played
from tiny_online import tiny_options
from toy import write_toy_set

from horizon_dl.cli import main, viewers
from horizon_dl.errors import InputError
from horizon_dl.runtime.ranged import ranges_of
from horizon_dl.visualization.live_page import Address, LivePage


@pytest.fixture
def page():
    live = LivePage(
        Address("127.0.0.1", 0), "A flight", lambda: {"watchdog": "ready", "left out": "<b>2</b>"}
    )
    yield live
    live.close()


def log(page: LivePage, index: int = 0) -> None:
    frame, prediction = scene(index)
    page.log(frame, prediction, ranges_of(frame, prediction))


def get(url: str, **headers: str) -> tuple[int, bytes]:
    try:
        with urllib.request.urlopen(urllib.request.Request(url, headers=headers), timeout=20) as answer:
            return answer.status, answer.read()
    except urllib.error.HTTPError as error:
        return error.code, error.read()


def test_picture_distances_and_figures(page: LivePage) -> None:
    assert get(page.url + "picture.jpg")[0] == 404
    assert json.loads(get(page.url + "state.json")[1])["frame"] == 0
    log(page, 3)
    state = json.loads(get(page.url + "state.json")[1])
    assert (state["frame"], state["name"], state["status"]["watchdog"]) == (1, "cam/003.png", "ready")
    ranges = state["ranges"]
    assert len(ranges["bearing_deg"]) == len(ranges["metres"]) == len(ranges["outcome"])
    assert "obstacle" in ranges["outcome"]
    code, picture = get(page.url + "picture.jpg?n=1")
    assert (code, picture[:2]) == (200, b"\xff\xd8")


def test_why_sectors_are_unknown_is_said_on_the_page(page: LivePage) -> None:
    frame, prediction = scene(3)
    ranges = ranges_of(frame, prediction)
    assert ranges is not None
    words = "unknown: unfamiliar floor, black"
    page.log(frame, prediction, replace(ranges, doubts=("unfamiliar floor", "black")))
    assert json.loads(get(page.url + "state.json")[1])["ranges"]["unknown"] == words
    with browser_page() as tab:
        tab.goto(page.url)
        until(tab, f"document.getElementById('plot').textContent.includes('{words}')")
        assert tab.get_attribute("#plot", "aria-label").endswith(f"Sectors {words}.")


def test_read_only_and_only_for_this_machine(page: LivePage) -> None:
    with socket.create_connection(("127.0.0.1", page.port), timeout=20) as peer:
        peer.sendall(b"POST / HTTP/1.0\r\nHost: localhost\r\n\r\n")
        assert b"501" in peer.recv(100)
    assert get(page.url, Host="evil.example")[0] == 403  # a web site that calls this address by its own name
    assert get(page.url + "../../etc/passwd")[0] == 404
    assert page.token == ""


def test_who_listens_wider_needs_the_token() -> None:
    live = LivePage(Address("0.0.0.0", 0), "A flight")
    try:
        here = f"http://127.0.0.1:{live.port}/"
        assert len(live.token) > 20
        assert live.url.endswith(f"?token={live.token}")
        for path in ("", "state.json", "picture.jpg", "state.json?token=wrong"):
            assert get(here + path)[0] == 403
        assert get(f"{here}state.json?token={live.token}")[0] == 200
    finally:
        live.close()


def test_addresses() -> None:
    assert Address.parse("8000").local
    assert not Address.parse("0.0.0.0:8000").local
    assert Address.parse("[::1]:8000").local
    with pytest.raises(InputError, match=r"is no \[HOST:\]PORT"):
        Address.parse("here")
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        with pytest.raises(InputError, match="cannot be listened on"):
            LivePage(Address("127.0.0.1", taken.getsockname()[1]), "")


def test_the_page_in_a_browser(page: LivePage) -> None:
    log(page, 1)
    for width in (390, 1400):
        with browser_page(width, dark=width == 390) as browser:
            browser.goto(page.url)
            until(browser, "document.getElementById('now').textContent.includes('cam/001.png')")
            until(browser, "document.getElementById('picture').naturalWidth > 500")
            assert browser.inner_text("#status").replace("\n", " ").startswith("watchdog ready")
            assert "<b>2</b>" in browser.inner_text("#status")
            assert "metres" in browser.get_attribute("#plot", "aria-label")
            assert browser.evaluate("document.documentElement.scrollWidth") <= width
            assert browser.complaints == []


def test_without_a_screen_show_is_one_line(
    monkeypatch: pytest.MonkeyPatch, capsys: Any, tmp_path: Path
) -> None:
    monkeypatch.setattr(viewers, "has_screen", lambda: False)
    data = part_of_the_embedded_flight(tmp_path / "set", 2)
    arguments = ["fly", str(REFERENCE), "--source", str(data), "--mavlink", "udpout:127.0.0.1:9", "--show"]
    assert main(arguments) == 2
    assert "--show: there is no screen here" in capsys.readouterr().err


def test_a_flight_leaves_film_page_and_figures(tmp_path: Path, capsys: Any) -> None:
    data, out = part_of_the_embedded_flight(tmp_path / "set", 12), tmp_path / "flight"
    url = "udpout:127.0.0.1:9"
    arguments = ["fly", str(REFERENCE), "--source", str(data), "--mavlink", url, "--record", str(out)]
    assert main([*arguments, "--serve", "0"]) == 0
    told = capsys.readouterr().out
    assert "live at http://127.0.0.1:" in told
    figures = json.loads((out / "flight.json").read_text())
    codec, times, _ = played(out / "film.mp4")
    assert codec == "h264"
    assert 1 <= len(times) <= figures["pictures"]["looked_at"]
    assert "messages" in (out / "index.html").read_text()
    assert main([*arguments]) == 2  # the film of an earlier flight is not overwritten
    assert "earlier flight" in capsys.readouterr().err


def test_an_online_run_is_watched_and_leaves_film_and_page(tmp_path: Path, capsys: Any) -> None:
    data, out = write_toy_set(tmp_path / "set", frames=24), tmp_path / "run"
    states: list[dict[str, Any]] = []
    watching = threading.Event()

    def watch() -> None:
        while not watching.is_set():
            time.sleep(0.05)
            found = capsys.readouterr().out
            if "live at " in found:
                url = found.split("live at ")[1].split()[0]
                while not watching.is_set():
                    try:
                        states.append(json.loads(get(url + "state.json")[1]))
                    except OSError:
                        return
                    time.sleep(0.05)

    watcher = threading.Thread(target=watch)
    watcher.start()
    try:
        assert main(["online", str(data), "--out", str(out), "--serve", "0", *tiny_options()]) == 0
    finally:
        watching.set()
        watcher.join()
    assert states
    assert max(state["frame"] for state in states) > 1
    assert "frames" in states[-1]["status"]
    assert len(played(out / "film.mp4")[1]) == 24
    page = (out / "index.html").read_text()
    assert "The net saw 24 frames" in page
    assert "metrics.json" in page


def test_training_says_that_these_frames_were_trained_on(tmp_path: Path) -> None:
    data, out = write_toy_set(tmp_path / "set", frames=12), tmp_path / "run"
    quick = [
        "--train.rounds",
        "[3]",
        "--train.crop",
        "32",
        "--train.batch",
        "2",
        "--image.max_pixels",
        "5000",
    ]
    assert main(["train", str(data), "--out", str(out), *quick]) == 0
    assert "of the same recording" in (out / "index.html").read_text()
    assert len(played(out / "film.mp4")[1]) == 12


def test_a_recording_for_rerun(tmp_path: Path) -> None:
    pytest.importorskip("rerun")
    from horizon_dl.visualization.rerun_sink import Rerun

    sink = Rerun(str(tmp_path / "flight.rrd"), "a flight")
    for index in range(3):
        frame, prediction = scene(index)
        sink.log(frame, prediction, ranges_of(frame, prediction))
    sink.close()
    content = (tmp_path / "flight.rrd").read_bytes()
    assert content[:4] == b"RRF2"
    for path in (
        b"camera/image",
        b"maps/flown",
        b"maps/surprisal",
        b"maps/entropy",
        b"body/distances",
        b"unknown",
        b"figures/nearest_m",
    ):
        assert path in content
    with pytest.raises(InputError, match=r"is no \.rrd file"):
        Rerun(str(tmp_path / "none" / "x.rrd"), "")

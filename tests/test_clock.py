"""Clocks that are apart by a known offset and drift are found from the pictures, with an honest doubt."""

import os
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from horizon_dl.cli import main
from horizon_dl.data.attitude_log import AttitudeLog, log_of_angles
from horizon_dl.data.given import Given
from horizon_dl.data.source import Recording
from horizon_dl.errors import InputError
from horizon_dl.geometry.camera import Camera
from horizon_dl.geometry.rays import camera_rays
from horizon_dl.logs.attitude_logs.registry import read_attitude_log
from horizon_dl.logs.clock.clock_fit import SYSTEMATIC_FRAMES, fit_clock
from horizon_dl.logs.clock.find_clock import find_clock
from horizon_dl.logs.clock.seen_turns import seen_turn, small_camera, small_grey
from horizon_dl.logs.clock.windows import Window
from horizon_dl.sources.open_source import open_source

CASES, DATA, LOGS = (Path(os.environ.get(f"HORIZON_DL_{name}", "none")) for name in ("CASES", "DATA", "LOGS"))
needs_cases = pytest.mark.skipif(not CASES.is_dir(), reason="needs HORIZON_DL_CASES")
needs_data = pytest.mark.skipif(not DATA.is_dir(), reason="needs HORIZON_DL_DATA")
FILM = CASES / "film"


def smooth_turns(rate_hz: float, seconds: float, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Times and summed turns of something that shakes at up to 2 Hz."""
    times = np.arange(0, seconds, 1 / rate_hz)
    chance = np.random.default_rng(seed)
    turns = np.zeros((len(times), 3))
    for frequency in chance.uniform(0.1, 2.0, 40):
        phase, size = chance.uniform(0, 2 * np.pi, 3), chance.normal(0, 0.01, 3)
        turns += size * np.sin(2 * np.pi * frequency * times[:, None] + phase)
    return times, turns


def window(
    offset_s: float, drift_ppm: float, seconds: float, noise: float = 0.001, film_s: float = 5.0
) -> Window:
    """A film of some seconds that begins 5 s into its log; clocks as in `AttitudeLog.on_clock`."""
    log_s, turns = smooth_turns(100.0, seconds + 20.0)
    on_frames = log_s[0] + offset_s + (log_s - log_s[0]) * (1 + drift_ppm * 1e-6)
    frames = np.arange(0, seconds, 1 / 30) + on_frames[0] + film_s
    at = np.stack([np.interp(frames, on_frames, axis) for axis in turns.T], axis=-1)
    seen = np.diff(at, axis=0) + np.random.default_rng(1).normal(0, noise, (len(frames) - 1, 3))
    seen[::17] = 0.3  # the measurement fails wildly now and then
    if seconds > 60:  # as of a long film: some stretches
        kept = (np.arange(len(seen)) // 300) % 4 == 0
        return Window(frames[:-1][kept], frames[1:][kept], seen[kept], log_s, turns)
    return Window(frames[:-1], frames[1:], seen, log_s, turns)


@pytest.mark.parametrize("offset_s", [0.0, 0.37, -4.2, -1.6e9, 30000.0])
def test_an_offset_is_found_to_a_fraction_of_a_frame(offset_s: float) -> None:
    fit = fit_clock(window(offset_s, 0.0, 40.0))
    assert fit is not None
    assert fit.sure
    assert abs(fit.offset_s - offset_s) < 1 / 60
    assert abs(fit.offset_s - offset_s) < 2 * fit.doubt_s


@pytest.mark.parametrize("drift_ppm", [0.0, 120.0, -1900.0, 6000.0])
def test_a_drift_is_found_over_minutes(drift_ppm: float) -> None:
    """0.5 s in 4.5 minutes, as was reported, is 1900 millionths."""
    fit = fit_clock(window(3.0, drift_ppm, 320.0))
    assert fit is not None
    assert fit.sure
    assert fit.drift_doubt_ppm is not None
    assert abs(fit.drift_ppm - drift_ppm) < 100
    middle = fit.offset_s + 150 * fit.drift_ppm * 1e-6
    assert abs(middle - 3.0 - 150 * drift_ppm * 1e-6) < 1 / 60


def test_what_has_nothing_in_common_is_not_sure() -> None:
    one = window(0.0, 0.0, 40.0)
    fit = fit_clock(replace(one, logged=smooth_turns(100.0, 60.0, seed=5)[1]))
    assert fit is None or not fit.sure


def test_the_doubt_holds_what_all_pictures_share_and_other_offsets() -> None:
    fit = fit_clock(window(0.37, 0.0, 40.0))
    assert fit is not None
    assert fit.doubt_s >= SYSTEMATIC_FRAMES * fit.frame_s
    # The same five seconds again and again: one offset is as good as the next but one.
    one = window(0.0, 0.0, 40.0)
    turns = one.logged[np.arange(len(one.logged)) % 500]
    seen = np.stack([np.interp(one.ends_s, one.log_times_s, axis) for axis in turns.T], axis=-1)
    seen -= np.stack([np.interp(one.starts_s, one.log_times_s, axis) for axis in turns.T], axis=-1)
    again = fit_clock(replace(one, logged=turns, seen=seen))
    assert again is not None
    assert not again.sure
    assert again.doubt_s > 4.0


def test_what_hardly_turns_is_not_sure() -> None:
    fit = fit_clock(window(0.0, 0.0, 40.0, noise=0.2))
    assert fit is None or not fit.sure


def test_a_turn_is_seen_about_every_axis() -> None:
    camera = Camera("pinhole", 320, 240, 250.0, 250.0, 159.5, 119.5)
    small = small_camera(camera)
    directions = camera_rays(camera).directions.astype(np.float64)

    def seen_from(turn: np.ndarray) -> np.ndarray:
        """Bands on the sky as a camera sees them that has turned by small angles."""
        d = directions + np.cross(turn, directions)
        waves = np.sin(25 * d[..., 0] + 7) + np.sin(31 * d[..., 1]) + np.sin(17 * (d[..., 0] + d[..., 1]))
        return np.repeat((127 + 40 * waves)[..., None], 3, axis=-1).astype(np.uint8)

    for turn in np.vstack([np.eye(3) * 0.01, -np.eye(3) * 0.02, [[0.03, -0.05, 0.01]]]):
        found = seen_turn(
            small, small_grey(seen_from(np.zeros(3)), small), small_grey(seen_from(turn), small)
        )
        assert found == pytest.approx(turn, abs=0.2 * float(np.abs(turn).max()))


def shifted(log: AttitudeLog, offset_s: float) -> AttitudeLog:
    return log.on_clock(-offset_s)


def within_half_a_frame(recording: Recording, log: AttitudeLog, offset_s: float) -> None:
    fit = find_clock(recording, shifted(log, offset_s))
    assert fit is not None
    assert fit.sure
    assert abs(fit.offset_s - offset_s) < fit.frame_s / 2
    assert abs(fit.offset_s - offset_s) < 2 * fit.doubt_s


@needs_cases
@pytest.mark.parametrize("offset_s", [0.0, 0.43, -1.7, -1.6e9])
def test_the_films_offset_is_found(offset_s: float) -> None:
    recording = open_source(FILM / "film.mp4", None, Given(FILM / "camera.yaml", str(FILM / "log_ok.csv")))
    assert isinstance(recording, Recording)
    within_half_a_frame(recording, read_attitude_log(FILM / "log_ok.csv"), offset_s)


def columns(path: Path, names: tuple[str, ...]) -> list[np.ndarray]:
    rows = [line.split(",") for line in path.read_text().splitlines()]
    return [np.array([float(row[rows[0].index(name)]) for row in rows[1:]]) for name in names]


@needs_data
@pytest.mark.slow
@pytest.mark.parametrize("offset_s", [0.43, 5000.0])
def test_the_corridors_offset_is_found(offset_s: float) -> None:
    times, *angles = columns(DATA / "corridor" / "frames.csv", ("time_s", "roll_rad", "pitch_rad", "yaw_rad"))
    recording = open_source(DATA / "corridor")
    assert isinstance(recording, Recording)
    within_half_a_frame(recording, log_of_angles(times, np.stack(angles, axis=-1)), offset_s)


@needs_data
@pytest.mark.slow
def test_the_arenas_offset_is_found() -> None:
    path = next((DATA / "arena").glob("*.csv"))
    times, *angles = columns(path, ("time", "att_phi", "att_theta", "att_psi"))
    recording = open_source(DATA / "arena")
    assert isinstance(recording, Recording)
    within_half_a_frame(recording, log_of_angles(times, np.stack(angles, axis=-1)), -2.7)


@pytest.mark.skipif(not LOGS.is_dir(), reason="needs HORIZON_DL_LOGS")
@pytest.mark.slow
def test_a_stabilised_film_does_not_tell_and_says_so() -> None:
    path, camera = LOGS / "gopro_max" / "max-heromode.mp4", DATA / "gopro_max_path" / "camera.yaml"
    recording = open_source(path, None, Given(camera))
    assert isinstance(recording, Recording)
    fit = find_clock(recording)
    assert fit is not None
    assert not fit.sure
    with pytest.raises(InputError, match="does not tell the offset"):
        open_source(path, None, Given(camera, find_offset=True))


@needs_cases
def test_both_ranges_are_told_before_the_first_frame() -> None:
    with pytest.raises(
        InputError, match=r"frames are from 0\.000 .* the log from 1600000000\.000 .*=-1600000000"
    ):
        open_source(FILM / "film.mp4", None, Given(FILM / "camera.yaml", str(FILM / "log_unix.csv")))


@needs_cases
@pytest.mark.slow
def test_the_command_finds_the_offset_and_prints_it(capsys: Any) -> None:
    command = ["check-data", str(FILM / "film.mp4"), "--camera", str(FILM / "camera.yaml")]
    log = ["--attitude", str(FILM / "log_unix.csv"), "--time-offset", "auto"]
    assert main([*command, *log]) == 0
    said = " ".join(capsys.readouterr().out.split())
    found = re.search(r"--time-offset=(-[0-9.]+)", said)
    assert found is not None
    assert float(found[1]) == pytest.approx(-1.6e9, abs=1 / 12)
    assert said.count("Clocks: ") == 1  # on the clock that was found, and nothing of the other one
    assert "the log from 0.0" in said or "the log from -0.0" in said
    assert "lie inside the log" not in said

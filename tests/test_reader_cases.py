"""Small inputs that went wrong, with what is right: the embedded flight in other formats."""

import os
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from horizon_dl.cli import main
from horizon_dl.data.source import Recording
from horizon_dl.logs.attitude_logs.csv_table import read as read_attitude_csv
from horizon_dl.readers.registry import open_recording
from horizon_dl.simulation.embedded import embedded_set

RIGHT = {  # case: frames, how many degrees its attitudes may be off, how many levels its pictures
    "csv_semicolon_comma": (40, 1e-4, 0.0),
    "csv_header_case": (40, 1e-4, 0.0),
    "csv_unix_ms": (40, 1e-4, 0.0),
    "img_exif3": (40, 1e-4, 1.0),
    "img_exif6": (8, 1e-4, 1.0),
    "img_gray12_in16": (8, 1e-4, 2.0),
    "kitti/oxts_100hz_in_sync": (30, 1e-4, 0.0),
    "tum/tabs": (30, 1e-3, 0.0),
    "tum/icl_yup_index": (30, 1e-3, 0.0),
    "euroc/tumvi_camera_yaml": (30, 1e-3, 2.0),
}


@pytest.fixture(scope="module")
def cases() -> Path:
    place = os.environ.get("HORIZON_DL_CASES")
    if not place:
        pytest.skip("needs HORIZON_DL_CASES")
    return Path(place)


@pytest.fixture(scope="module")
def flight() -> Recording:
    return open_recording(embedded_set())


@pytest.mark.parametrize("name", list(RIGHT))
def test_case(cases: Path, flight: Recording, name: str) -> None:
    frames, degrees, levels = RIGHT[name]
    recording = open_recording(cases / name)
    assert recording.length == frames
    apart = [
        np.degrees(np.arccos(np.clip(found.up_cam @ wanted.up_cam, -1, 1)))
        for found, wanted in zip(recording.headers, flight.headers, strict=False)
        if found.up_cam is not None and wanted.up_cam is not None
    ]
    assert len(apart) == frames
    assert max(apart) <= degrees
    rate = 30.0 if name == "tum/icl_yup_index" else 6.0  # numbers of frames have no rate of their own
    steps = np.diff([header.time_s for header in recording.headers])
    np.testing.assert_allclose(steps, 1 / rate, atol=2e-3)
    picture, wanted_picture = recording.read(3).image, flight.read(3).image
    if levels == 2.0:  # grey
        picture, wanted_picture = picture.mean(axis=-1), wanted_picture @ [0.299, 0.587, 0.114]
    assert np.abs(picture.astype(float) - wanted_picture).mean() <= levels
    if recording.format != "images_csv":
        return
    heights = [
        (found.height_m, wanted.height_m)
        for found, wanted in zip(recording.headers, flight.headers, strict=False)
    ]
    assert all(found == pytest.approx(wanted) for found, wanted in heights)


@pytest.mark.parametrize("name", ["log_ok", "log_ms", "log_us_boot", "log_unix"])
def test_logs_of_the_film(cases: Path, flight: Recording, name: str) -> None:
    log = read_attitude_csv(cases / "film" / f"{name}.csv")
    start = 1.6e9 if name == "log_unix" else 0.0
    times = np.array([header.time_s for header in flight.headers[: len(log.times_s)]])
    np.testing.assert_allclose(log.times_s - start, times - times[0], atol=1e-3)
    assert bool(log.notes) == (name in ("log_ms", "log_us_boot"))


@pytest.mark.parametrize("verb", ["train", "compare", "online"])
def test_no_verb_learns_from_a_camera_that_looks_down(
    cases: Path, tmp_path: Path, capsys: Any, verb: str
) -> None:
    assert main([verb, str(cases / "looks_down"), "--out", str(tmp_path / "out")]) == 2
    error = capsys.readouterr().err
    assert "the horizon is almost never in the image" in error
    assert "--force" in error
    assert not (tmp_path / "out").exists()

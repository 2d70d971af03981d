"""Attitude from pictures alone: of edges and skies made with a known one, and of the simulated flight."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from test_mount import scene

from horizon_dl.data.from_images import up_from_picture, with_attitude_from_images
from horizon_dl.data.given import Given
from horizon_dl.errors import InputError
from horizon_dl.geometry.attitude import up_in_camera
from horizon_dl.geometry.camera import Camera
from horizon_dl.geometry.horizon_line import up_from_colours, up_from_map
from horizon_dl.geometry.lines import LinePlanes
from horizon_dl.geometry.manhattan import up_from_edges
from horizon_dl.geometry.rays import camera_rays
from horizon_dl.geometry.tilts import roll_pitch_of, up_of
from horizon_dl.readers.registry import open_recording
from horizon_dl.simulation.embedded import embedded_set

CAMERA = Camera("pinhole", 64, 48, 50.0, 50.0, 31.5, 23.5)
TILTS = [(0.0, 0.0), (0.35, -0.1), (-0.2, 0.25)]


def off_deg(first: np.ndarray, second: np.ndarray) -> float:
    return float(np.degrees(np.arccos(np.clip(first @ second, -1, 1))))


def test_tilts_are_undone() -> None:
    for roll, pitch in TILTS:
        assert roll_pitch_of(up_of(roll, pitch)) == pytest.approx((roll, pitch))


def test_edges_of_a_room_tell_up() -> None:
    planes, attitudes = scene((0.0, 0.0, 0.0), verticals=15, level=25, clutter=20, frames=6)
    for one, attitude in zip(planes, attitudes, strict=True):
        found = up_from_edges(one)
        assert found is not None
        assert off_deg(found.up_cam, up_in_camera(attitude, (0, 0, 0))) < 1.0
        assert np.degrees(found.sd_rad) < 2.0


def test_edges_without_order_leave_doubt() -> None:
    planes, _ = scene((0.0, 0.0, 0.0), verticals=0, level=0, clutter=40, frames=4)
    assert min(up_from_edges(one).sd_rad for one in planes) > np.radians(4.0)  # type: ignore[union-attr]
    assert up_from_edges(LinePlanes(planes[0].normal[:3], planes[0].length_rad[:3])) is None


def sea(roll: float, pitch: float) -> np.ndarray:
    """Sky over sea, each with waves or clouds of its own."""
    above = camera_rays(CAMERA).directions @ up_of(roll, pitch) > 0
    noise = np.random.default_rng(0).normal(0, 8, (48, 64, 1))
    picture = np.where(above[..., None], [190, 210, 235], [30, 70, 80]) + noise
    return picture.clip(0, 255).astype(np.uint8)


@pytest.mark.parametrize(("roll", "pitch"), TILTS)
def test_the_sea_s_horizon_tells_up(roll: float, pitch: float) -> None:
    found = up_from_colours(sea(roll, pitch), camera_rays(CAMERA).directions)
    assert found is not None
    assert off_deg(found.up_cam, up_of(roll, pitch)) < 1.0
    assert np.degrees(found.sd_rad) < 2.0


def test_a_plain_picture_tells_nothing() -> None:
    noise = np.random.default_rng(1).integers(0, 255, (48, 64, 3)).astype(np.uint8)
    assert up_from_colours(noise, camera_rays(CAMERA).directions) is None
    assert up_from_map(np.zeros((48, 64)), camera_rays(CAMERA).directions) is None


@pytest.mark.parametrize(("roll", "pitch"), TILTS)
def test_a_map_of_what_is_above_tells_up(roll: float, pitch: float) -> None:
    """Half of the map is unsure, as it is where obstacles stand."""
    rays = camera_rays(CAMERA).directions
    p_above = 1 / (1 + np.exp(-20 * rays @ up_of(roll, pitch)))
    p_above[:, 20:40] = 0.5
    found = up_from_map(p_above, rays)
    assert found is not None
    assert off_deg(found.up_cam, up_of(roll, pitch)) < 2.0


def test_pictures_of_a_sea_become_a_recording(tmp_path: Path) -> None:
    (tmp_path / "pictures").mkdir()
    for index, (roll, pitch) in enumerate(TILTS):
        Image.fromarray(sea(roll, pitch)).save(tmp_path / "pictures" / f"{index}.png")
    camera = tmp_path / "camera.yaml"
    camera.write_text("model: pinhole\nwidth: 64\nheight: 48\nfx: 50\nfy: 50\ncx: 31.5\ncy: 23.5\n")
    given = Given(camera=camera, attitude="from-images")
    recording = open_recording(tmp_path / "pictures", given=given)
    for header, tilt in zip(recording.headers, TILTS, strict=True):
        assert header.up_cam is not None
        assert off_deg(header.up_cam, up_of(*tilt)) < 1.0
    assert "roll and pitch are from the pictures, in 3 of 3" in recording.notes[-1]
    with pytest.raises(InputError, match="needs to know the camera; give --camera FILE"):
        open_recording(tmp_path / "pictures", given=Given(attitude="from-images"))


def test_pictures_that_tell_nothing_are_said_so(tmp_path: Path) -> None:
    for index in range(2):
        Image.new("RGB", (64, 48), (90, 90, 90)).save(tmp_path / f"{index}.png")
    camera = tmp_path / "camera.yaml"
    camera.write_text("model: pinhole\nwidth: 64\nheight: 48\nfx: 50\nfy: 50\ncx: 31.5\ncy: 23.5\n")
    with pytest.raises(InputError, match="do not tell how the camera is held"):
        open_recording(tmp_path, given=Given(camera=camera, attitude="from-images"))


def test_the_simulated_arena(tmp_path: Path) -> None:
    recording = open_recording(embedded_set()).select(range(0, 180, 30))
    found = with_attitude_from_images(recording)
    known = [
        off_deg(mine.up_cam, true.up_cam)
        for mine, true in zip(found.headers, recording.headers, strict=True)
        if mine.up_cam is not None and true.up_cam is not None
    ]
    assert len(known) >= 3
    assert np.median(known) < 3.0
    assert up_from_picture(recording.read(0)) is not None

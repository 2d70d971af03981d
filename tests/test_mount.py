"""The mount's error from edges: of planes built from a known mount, and of the simulated flight."""

import json
import math
import shutil
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from horizon_dl.cli import main
from horizon_dl.errors import InputError
from horizon_dl.geometry.attitude import (
    quaternion_from_rpy,
    rotation_from_rpy,
    rpy_from_rotation,
    up_in_camera,
)
from horizon_dl.geometry.camera import Camera
from horizon_dl.geometry.lines import LinePlanes, line_planes
from horizon_dl.inspection.mount import corrected_mount, corrected_up, fit_mount
from horizon_dl.inspection.mount_check import check_mount, is_sure, mount_lines
from horizon_dl.readers.registry import open_recording
from horizon_dl.simulation.embedded import embedded_set

Floats = NDArray[np.float64]


def unit(vectors: Floats) -> Floats:
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def scene(
    true_mount: tuple[float, float, float], verticals: int, level: int, clutter: int, frames: int = 20
) -> tuple[list[LinePlanes], list[Floats]]:
    """Planes of upright, level and arbitrary edges under changing attitudes; the attitudes' quaternions."""
    rng = np.random.default_rng(1)
    planes, attitudes = [], []
    for _ in range(frames):
        camera = rotation_from_rpy(*rng.normal([0.0, -0.3], 0.15), rng.uniform(-3, 3))
        q = quaternion_from_rpy(*rpy_from_rotation(camera @ rotation_from_rpy(*true_mount).T))
        up = up_in_camera(q, true_mount)
        rays = unit(np.column_stack([rng.uniform(-0.7, 0.7, (999, 2)), np.ones(999)]))
        along = unit(np.cross(up, rng.normal(size=3)))
        directions = np.concatenate(
            [
                np.repeat(up[None], verticals, 0),
                np.where(rng.random((level, 1)) < 0.5, along, np.cross(up, along)),
                unit(rng.normal(size=(clutter, 3))),
            ]
        )
        normal = np.cross(rays[: len(directions)], directions)
        normal = unit(normal) + rng.normal(0, 0.004, normal.shape)
        planes.append(LinePlanes(unit(normal), rng.uniform(0.05, 0.3, len(normal))))
        attitudes.append(q)
    return planes, attitudes


@pytest.mark.parametrize(("roll", "pitch"), [(0.0, 0.0), (4.3, -3.1), (-2.2, 6.4)])
@pytest.mark.parametrize(
    "stated_deg", [(0.0, 0.0, 0.0), (2.0, -25.0, 15.0), (90.0, -20.0, 0.0), (180.0, 5.0, 9.0), (-82, 80, 81)]
)
def test_a_known_error_is_found(roll: float, pitch: float, stated_deg: tuple[float, float, float]) -> None:
    stated = tuple(map(math.radians, stated_deg))
    turn = rotation_from_rpy(math.radians(roll), math.radians(pitch), 0.0)
    true = rpy_from_rotation(rotation_from_rpy(*stated) @ turn)
    planes, attitudes = scene(true, verticals=12, level=15, clutter=30)
    fit = fit_mount(planes, [up_in_camera(q, stated) for q in attitudes])
    assert fit is not None
    assert math.degrees(fit.roll.correction) == pytest.approx(roll, abs=0.3)
    assert math.degrees(fit.pitch.correction) == pytest.approx(pitch, abs=0.3)
    assert fit.level_pitch is not None
    assert math.degrees(fit.level_pitch) == pytest.approx(pitch, abs=1.0)
    assert is_sure(fit.roll)
    assert is_sure(fit.pitch)


def test_clutter_alone_tells_nothing() -> None:
    planes, attitudes = scene((0.0, 0.0, 0.0), verticals=0, level=0, clutter=40)
    fit = fit_mount(planes, [up_in_camera(q, (0, 0, 0)) for q in attitudes])
    assert fit is not None
    assert not is_sure(fit.roll)
    assert not is_sure(fit.pitch)


def test_few_frames_tell_nothing() -> None:
    planes, attitudes = scene((0.0, 0.0, 0.0), verticals=9, level=9, clutter=9, frames=4)
    assert fit_mount(planes, [up_in_camera(q, (0, 0, 0)) for q in attitudes]) is None


@pytest.mark.parametrize("stated", [(0.0, -0.4, 0.2), (1.6, -0.4, 0.2), (-1.43, 1.4, 1.41)])
def test_corrected_up_is_that_of_the_corrected_mount(stated: tuple[float, float, float]) -> None:
    q = quaternion_from_rpy(0.2, -0.3, 1.0)
    turned = corrected_up(up_in_camera(q, stated)[None], 0.07, -0.03)
    np.testing.assert_allclose(turned[0], up_in_camera(q, corrected_mount(stated, 0.07, -0.03)), atol=1e-12)


def test_corrections_add_up_where_the_camera_stands_upright() -> None:
    np.testing.assert_allclose(corrected_mount((0.0, -0.4, 0.2), 0.07, -0.03), (0.07, -0.43, 0.2), atol=1e-12)


def test_an_edge_lies_in_its_plane() -> None:
    image = np.zeros((120, 160, 3), np.uint8)
    image[:, 100:] = 200
    camera = Camera("pinhole", 160, 120, 100.0, 100.0, 79.5, 59.5)
    found = line_planes(image, camera)
    assert len(found.normal)
    ray = np.array([(99.5 - 79.5) / 100, 0.3, 1.0])
    assert np.abs(found.normal @ ray / np.linalg.norm(ray)).max() < 0.01
    assert found.length_rad.max() == pytest.approx(2 * math.atan(0.6), abs=0.1)
    assert len(line_planes(np.zeros_like(image), camera).normal) == 0


def copy_of_the_embedded_set(folder: Path, mount: str) -> Path:
    shutil.copytree(embedded_set(), folder, ignore=shutil.ignore_patterns("depth", "labels"))
    text = (folder / "camera.yaml").read_text()
    (folder / "camera.yaml").write_text(text[: text.index("mount_rpy_deg")] + f"mount_rpy_deg: {mount}\n")
    return folder


def test_the_verb_finds_the_simulated_cameras_mount(tmp_path: Path, capsys: Any) -> None:
    data = copy_of_the_embedded_set(tmp_path / "set", "[3.5, -12.0, 0.0]")
    assert main(["calibrate-mount", str(data), "--out", str(tmp_path / "out")]) == 0
    found = json.loads((tmp_path / "out" / "mount.json").read_text())
    np.testing.assert_allclose(found["mount_rpy_deg"], [0.0, -9.0, 0.0], atol=0.3)
    assert found["is_off"]
    assert found["level_agrees"]
    assert "mount_rpy_deg: [" in capsys.readouterr().out
    # What it says, written into the file, leaves nothing to say.
    line = f"mount_rpy_deg: {found['mount_rpy_deg']}"
    text = (data / "camera.yaml").read_text()
    (data / "camera.yaml").write_text(text[: text.index("mount_rpy_deg")] + line)
    assert main(["calibrate-mount", str(data)]) == 0
    assert "Nothing speaks against" in capsys.readouterr().out


def test_of_a_format_that_states_no_mount_the_camera_is_turned(tmp_path: Path) -> None:
    recording = open_recording(copy_of_the_embedded_set(tmp_path / "set", "[3.5, -12.0, 0.0]"))
    check = check_mount(replace(recording, mount_rpy_rad=None))
    assert check.is_off
    assert "no file states a mount" in mount_lines(check)[-1]
    assert "mount_rpy_deg" not in mount_lines(check)[-1]


def test_images_without_edges_are_one_line(tmp_path: Path, capsys: Any) -> None:
    import make_sets

    rows = [f"images/{i}.png,{0.1 * i},0.0,0.0,0.0,1.5" for i in range(8)]
    assert main(["calibrate-mount", str(make_sets.images_csv(tmp_path / "flat", rows))]) == 2
    assert "do not tell how the camera is mounted" in capsys.readouterr().err


@pytest.mark.real_data
def test_the_hallways_camera_looks_up(data_dir: Path) -> None:
    check = check_mount(open_recording(data_dir / "hallway"))
    # Vanishing points read off by hand lie 2.1 to 3.9 degrees below the stated horizon.
    assert 1.5 < math.degrees(check.fit.pitch.correction) < 3.5
    assert check.level_agrees


@pytest.mark.real_data
def test_what_the_images_cannot_tell_is_not_told(data_dir: Path) -> None:
    with pytest.raises(InputError, match="do not tell"):
        check_mount(open_recording(data_dir / "euroc_sample"))

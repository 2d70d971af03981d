"""Conventions of the attitude: read as stated, read otherwise, and found from turns that pictures show."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from horizon_dl.cli import main
from horizon_dl.data.convention import Convention, parse_convention, reading_with
from horizon_dl.data.source import Recording
from horizon_dl.errors import InputError
from horizon_dl.geometry.attitude import quaternion_from_rpy, up_in_camera
from horizon_dl.geometry.axes import ALL_AXES, frd_from_axes
from horizon_dl.geometry.camera import Camera
from horizon_dl.inspection import conventions
from horizon_dl.inspection.conventions import fit_conventions
from horizon_dl.inspection.image_rotation import rotation_between
from horizon_dl.inspection.turns import Turns, logged_motion, measure_turns, window_indices
from horizon_dl.readers.registry import open_recording
from horizon_dl.simulation.embedded import embedded_set

Floats = NDArray[np.float64]
ENU_FROM_NED = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]])
Y_UP_FROM_NED = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, -1.0], [-1.0, 0.0, 0.0]])
FLU = np.diag([1.0, -1.0, -1.0])


def written(kind: str, angles: Floats) -> Floats:
    """Roll, pitch, yaw (rad, FRD in NED) as another program would write them."""
    matrices = Rotation.from_euler("ZYX", angles[:, ::-1]).as_matrix()
    if kind == "deg":
        return np.degrees(angles)
    if kind == "flu":
        return np.asarray(angles * [1, -1, -1])
    if kind == "xyzw":
        return np.asarray(Rotation.from_matrix(matrices).as_quat())
    if kind == "xyzw flu z-up":
        return np.asarray(Rotation.from_matrix(ENU_FROM_NED @ matrices @ FLU).as_quat())
    if kind == "xyzw rdf z-up":
        optical = frd_from_axes("rdf")
        return np.asarray(Rotation.from_matrix(ENU_FROM_NED @ matrices @ optical).as_quat())
    if kind == "y-up":
        return np.asarray(Rotation.from_matrix(Y_UP_FROM_NED @ matrices).as_quat()[:, [3, 0, 1, 2]])
    if kind == "inverse":
        return np.asarray(Rotation.from_matrix(matrices).inv().as_quat()[:, [3, 0, 1, 2]])
    return angles


KINDS = ("deg", "flu", "xyzw", "xyzw flu z-up", "xyzw rdf z-up", "y-up", "inverse")
EFFECT = {"flu": "flu z-up"}
"""Angles of a body with y left and z up are about a world whose z is up."""


def flight(count: int = 100, seed: int = 0) -> Floats:
    """Roll, pitch, yaw of a smooth flight, rad."""
    rng = np.random.default_rng(seed)
    time = np.arange(count) * 0.1
    parts = [
        sum(rng.normal() * np.sin(rng.uniform(1, 3) * time + rng.uniform(0, 6)) for _ in range(3))
        for _ in "rpy"
    ]
    return np.stack(parts, -1) * [0.12, 0.1, 0.4] + [0.02, -0.1, 0.6]


def seen(angles: Floats, mount: tuple[float, float, float], noise_rad: float = 0.002) -> Turns:
    """The turns that such a flight shows, in stretches of nine frames."""
    rng = np.random.default_rng(1)
    camera_from_frd = reading_with(Convention(), mount).mount
    world = Rotation.from_euler("ZYX", angles[:, ::-1]).as_matrix() @ camera_from_frd.T
    rows = []
    for start in range(0, len(angles) - 9, 9):
        for span in (1, 2, 4, 8):
            for first in range(start, start + 9 - span):
                noise = Rotation.from_rotvec(rng.normal(0, noise_rad, 3)).as_matrix()
                rows.append((first, first + span, noise @ world[first + span].T @ world[first], start // 9))
    first, second, number = (np.array([row[k] for row in rows]) for k in (0, 1, 3))
    return Turns(first, second, np.array([row[2] for row in rows]), number, len(rows))


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("mount_deg", [(0.0, 0.0, 0.0), (2.0, -20.0, 5.0)])
def test_ups_are_those_of_the_convention(kind: str, mount_deg: tuple[float, float, float]) -> None:
    angles, mount = flight(20), tuple(np.radians(mount_deg))
    reading = reading_with(Convention(), mount)
    convention = parse_convention(EFFECT.get(kind, kind), Convention())
    ups = convention.ups_in_camera(written(kind, angles), reading.mount)
    wanted = [up_in_camera(quaternion_from_rpy(*row), mount) for row in angles]
    np.testing.assert_allclose(ups, wanted, atol=1e-9)


@pytest.mark.parametrize("kind", ["as stated", *KINDS])
@pytest.mark.parametrize("error_deg", [0.0, 25.0])
def test_a_convention_is_found_from_turns(kind: str, error_deg: float) -> None:
    angles, mount = flight(), (0.0, np.radians(-15.0), 0.0)
    numbers = written(kind, angles)
    stated = (np.radians(error_deg) / 2, mount[1] + np.radians(error_deg), 0.0)
    fit = fit_conventions(
        seen(angles, mount), [tuple(row) for row in numbers], reading_with(Convention(), stated)
    )
    assert fit is not None
    assert fit.told
    assert fit.sure == (kind != "as stated")
    words = " ".join(fit.best.convention.differences(Convention(), numbers.shape[1] == 4))
    assert words == ("" if kind == "as stated" else EFFECT.get(kind, kind))


@pytest.mark.parametrize("kind", ["as stated", "flu"])
def test_a_better_reading_that_may_be_chance_is_no_ok(kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """As in a short film: another reading misses far less, but not by enough deviations to be named."""
    monkeypatch.setattr(conventions, "SURE", 1e9)
    angles, mount = flight(), (0.0, np.radians(-15.0), 0.0)
    rows = [tuple(row) for row in written(kind, angles)]
    fit = fit_conventions(seen(angles, mount), rows, reading_with(Convention(), mount))
    assert fit is not None
    assert not fit.sure
    assert fit.told == (kind == "as stated")


def test_a_camera_that_hardly_turns_tells_nothing() -> None:
    angles = flight() * 0.002
    fit = fit_conventions(
        seen(angles, (0, 0, 0)), [tuple(row) for row in angles], reading_with(Convention(), (0, 0, 0))
    )
    assert fit is not None
    assert not fit.sure
    assert not fit.told
    assert (
        fit_conventions(seen(flight(12), (0, 0, 0)), [None] * 12, reading_with(Convention(), (0, 0, 0)))
        is None
    )


def test_words_of_a_convention() -> None:
    assert parse_convention("xyzw, FLU z-up", Convention()) == Convention("flu", "z", "xyzw")
    assert parse_convention("deg y-down inverse", Convention()) == Convention(
        up="-y", unit="deg", inverse=True
    )
    for word in ("sideways", "ffu", "wxzy"):
        with pytest.raises(InputError, match="--convention"):
            parse_convention(word, Convention())
    assert len(ALL_AXES) == 24


def test_a_turn_is_seen_in_the_picture() -> None:
    rng = np.random.default_rng(0)
    camera = Camera("pinhole", 320, 240, 210.0, 210.0, 159.5, 119.5)
    import cv2

    texture = cv2.GaussianBlur(rng.uniform(0, 255, (240, 320)).astype(np.float32), (0, 0), 2.0)
    texture = np.clip((texture - texture.mean()) * 6 + 128, 0, 255).astype(np.uint8)
    turn = Rotation.from_rotvec(np.radians([1.5, -2.0, 3.0])).as_matrix()
    matrix = np.array([[210.0, 0, 159.5], [0, 210.0, 119.5], [0, 0, 1]])
    turned = cv2.warpPerspective(texture, matrix @ turn @ np.linalg.inv(matrix), (320, 240))
    found = rotation_between(camera, texture, turned)
    assert found is not None
    assert np.degrees(Rotation.from_matrix(found @ turn.T).magnitude()) < 0.1
    assert rotation_between(camera, texture, np.full_like(texture, 128)) is None


@pytest.fixture(scope="module")
def embedded() -> tuple[Recording, Turns]:
    recording = open_recording(embedded_set())
    return recording, measure_turns(recording)


@pytest.mark.parametrize("kind", ["as stated", "deg", "flu", "xyzw", "xyzw flu z-up", "y-up"])
def test_every_convention_is_named_on_the_embedded_flight(
    embedded: tuple[Recording, Turns], kind: str
) -> None:
    recording, turns = embedded
    assert recording.reading is not None
    numbers = written(kind, np.array([header.as_read for header in recording.headers]))
    fit = fit_conventions(turns, [tuple(row) for row in numbers], recording.reading)
    assert fit is not None
    words = " ".join(fit.best.convention.differences(Convention(), numbers.shape[1] == 4))
    assert words == ("" if kind == "as stated" else EFFECT.get(kind, kind))


def test_a_recording_is_read_otherwise(tmp_path: Path, capsys: Any) -> None:
    import make_sets

    rows = [f"images/{i}.png,{0.1 * i},{0.5 * i},-5.0,6.0,1.5" for i in range(8)]
    recording = open_recording(make_sets.images_csv(tmp_path / "set", rows))
    degrees = recording.read_as("deg")
    for index, header in enumerate(degrees.headers):
        angles = np.radians([0.5 * index, -5.0, 6.0])
        assert header.up_cam is not None
        np.testing.assert_allclose(
            header.up_cam, up_in_camera(quaternion_from_rpy(*angles), (0, 0, 0)), atol=1e-9
        )
    with pytest.raises(InputError, match="one convention"):
        replace(recording, reading=None).read_as("deg")
    assert main(["check-data", str(tmp_path / "set"), "--convention", "sideways"]) == 2
    assert "--convention sideways" in capsys.readouterr().err


def test_the_liveliest_stretches_are_looked_at() -> None:
    motion = np.zeros(999)
    motion[[100, 450, 451, 452, 803]] = 1.0
    windows = window_indices(1000, motion)
    assert len(windows) == 12
    assert all(len(one) == 9 for one in windows)
    assert len({index for one in windows for index in one}) == 12 * 9
    for moved in (100, 450, 452, 803):
        assert any(one[0] <= moved < one[-1] + 1 for one in windows)
    assert window_indices(1000, np.zeros(999)) == window_indices(1000)


def test_motion_of_the_log_is_that_of_its_attitudes() -> None:
    recording = open_recording(embedded_set())
    motion = logged_motion(recording)
    assert motion is not None
    angles = np.array([header.as_read for header in recording.headers])
    turned = Rotation.from_euler("ZYX", angles[:, ::-1])
    np.testing.assert_allclose(motion, (turned[:-1].inv() * turned[1:]).magnitude(), atol=1e-6)
    assert logged_motion(replace(recording, reading=None)) is None

"""How the camera sits on what told the attitude: by tf, else as the user states it."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from horizon_dl.calibration.calibration import Calibration
from horizon_dl.data.convention import Convention, Reading
from horizon_dl.data.frame import FrameHeader
from horizon_dl.errors import InputError
from horizon_dl.geometry.attitude import OPTICAL_FROM_FRD, MountRpy, rotation_from_rpy, rpy_from_rotation
from horizon_dl.geometry.axes import frd_from_axes
from horizon_dl.logs.bags.choose import Series, body_frame
from horizon_dl.logs.bags.linked import Linked
from horizon_dl.logs.bags.transforms import TransformTree
from horizon_dl.logs.bags.up_series import Turned

Floats = NDArray[np.float64]

FRD_FROM_FLU = np.diag([1.0, -1.0, -1.0])
UPRIGHT_FROM_STORED = np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
"""Optical axes after a quarter turn of the picture to the left."""


@dataclass(frozen=True)
class Mounted:
    """A series of up directions, and the way from its frame to the upright camera.

    Attributes:
        series: see `UpSeries`.
        tree: gives the way from `frame` to `camera_frame` at each time, where that changes.
        frame: that the tree leads to; None: `sensor_from_camera` is all.
        camera_frame: of the pictures as they are stored.
        sensor_from_camera: (3, 3) from the upright camera; with a tree what is to be added on its right.
        mount_rpy_rad: of the camera in the body (FRD), where that is constant and known.
        notes: for the user.
        by_arrival: times are those of arrival.
    """

    series: Series
    tree: TransformTree
    frame: str | None
    camera_frame: str
    sensor_from_camera: Floats
    mount_rpy_rad: MountRpy | None
    notes: tuple[str, ...]
    by_arrival: bool = False

    def header(self, name: str, time_s: float, offset_s: float) -> FrameHeader:
        """What is known of a picture at its time."""
        turned: Floats | None = self.sensor_from_camera
        if self.frame is not None:
            way = self.tree.rotation(self.frame, self.camera_frame, time_s - offset_s)
            turned = None if way is None else way @ self.sensor_from_camera
            if turned is not None and self._flips:
                turned = FRD_FROM_FLU @ turned
        if turned is None:
            return FrameHeader(name, time_s)
        up_cam, yaw_rad = self.series.at(time_s - offset_s, turned)
        numbers = self.series.as_read(time_s - offset_s) if isinstance(self.series, Turned) else None
        return FrameHeader(name, time_s, up_cam, yaw_rad, as_read=numbers)

    @property
    def _flips(self) -> bool:
        """Whether the tree's frame is the body as REP 103 has it, the series' axes forward, right, down."""
        return self.series.frd and not self.series.frame

    @property
    def reading(self) -> Reading | None:
        """How the quaternions were read; None where there are none, or the camera turns in the body."""
        if not isinstance(self.series, Turned):
            return None
        way: Floats | None = self.sensor_from_camera
        if self.frame is not None:
            constant = self.tree.constant(self.frame, self.camera_frame)
            turned = self.tree.rotation(self.frame, self.camera_frame, 0.0) if constant else None
            way = None if turned is None else turned @ self.sensor_from_camera
            if way is not None and self._flips:
                way = FRD_FROM_FLU @ way
        if way is None:
            return None
        body, up = "frd" if self.series.frd else "flu", "z" if self.series.up_world[2] > 0 else "-z"
        return Reading(Convention(body, up), tuple((way.T @ frd_from_axes(body).T).ravel().tolist()))


def mounted(
    path: Path,
    tree: TransformTree,
    series: Series,
    camera_frame: str,
    calibration: Calibration,
    *,
    has_mount: bool,
) -> Mounted:
    """The series on its camera; a mount that the user states, if it is not zero, goes before tf.

    Args:
        path: of the bag.
        tree: its transforms.
        series: what told the attitude.
        camera_frame: of the pictures.
        calibration: the camera's.
        has_mount: the calibration is the user's file, and may hold a mount.

    Raises:
        InputError: nothing tells how the camera sits.
    """
    turned_back = np.linalg.matrix_power(UPRIGHT_FROM_STORED, calibration.rotate_quarter_turns_ccw).T
    frame = series.frame or body_frame(tree, camera_frame)
    notes = [f"attitude of {series.topic}", *[series.note] * bool(series.note), *tree.notes]
    itself = isinstance(series, Linked) or (bool(frame) and frame == camera_frame)
    if itself:
        return Mounted(series, tree, None, camera_frame, turned_back, None, tuple(notes))
    stated = has_mount and any(calibration.mount_rpy_rad)
    if frame and not stated and tree.connected(frame, camera_frame) and camera_frame:
        mount = _constant_mount(tree, frame, camera_frame, turned_back)
        notes.append(f"the camera's mount is by tf, {camera_frame} in {frame}")
        return Mounted(series, tree, frame, camera_frame, turned_back, mount, tuple(notes))
    if not has_mount:
        raise InputError(
            path,
            f"nothing says how the camera ({camera_frame or 'without a frame'}) sits on what {series.topic} "
            f"measures ({series.frame or 'the body'}): no tf joins them",
            "give --camera FILE with mount_rpy_deg",
        )
    mount = calibration.mount_rpy_rad
    frd_from_camera = rotation_from_rpy(*mount) @ OPTICAL_FROM_FRD.T
    way = frd_from_camera if series.frd else FRD_FROM_FLU @ frd_from_camera
    notes.append(f"the mount is the camera file's, on axes of {'FRD' if series.frd else 'FLU'}")
    return Mounted(series, tree, None, camera_frame, way, mount, tuple(notes))


def _constant_mount(
    tree: TransformTree, frame: str, camera_frame: str, turned_back: Floats
) -> MountRpy | None:
    if not tree.constant(frame, camera_frame):
        return None
    way = tree.rotation(frame, camera_frame, 0.0)
    return None if way is None else rpy_from_rotation(FRD_FROM_FLU @ way @ turned_back @ OPTICAL_FROM_FRD)

"""One door for camera files of every kind."""

import re
from dataclasses import dataclass
from pathlib import Path

from horizon_dl.calibration.candidate import Wanted, choose
from horizon_dl.calibration.fields import Fields
from horizon_dl.calibration.mount import ImuMount, Mount, mount_of, rotation_of_axes
from horizon_dl.calibration.registry import cameras_in
from horizon_dl.calibration.tree import read_tree
from horizon_dl.errors import InputError
from horizon_dl.geometry.camera import Camera

QUARTER_TURNS_CCW = {"none": 0, "0": 0, "90ccw": 1, "90cw": 3, "180": 2, "270ccw": 3, "270cw": 1}


COMMON = ("rotate_image", "mount_rpy_deg", "imu_axes", "use_camera")
"""Fields that may stand in every kind of file."""
_LIKE_COMMON = re.compile(r"(mount|rotat|imu_ax|use_cam)", re.IGNORECASE)


@dataclass(frozen=True)
class Calibration:
    """A camera and how it sits in the body.

    Attributes:
        camera: intrinsics of the upright image.
        rotate_quarter_turns_ccw: how the stored image is turned to be upright.
        mount: roll, pitch, yaw (rad) of the camera in the body (FRD); or in an IMU whose axes are not stated;
            None: the camera itself is the body.
        notes: what was done that the user should know, a sentence each.
        imu_axes: of the IMU beside the camera, as flu, where they are stated.
    """

    camera: Camera
    rotate_quarter_turns_ccw: int = 0
    mount: Mount | ImuMount | None = (0.0, 0.0, 0.0)
    notes: tuple[str, ...] = ()
    imu_axes: str | None = None

    @property
    def mount_rpy_rad(self) -> Mount:
        """The mount; AxesNotStatedError where it cannot be known. Who needs the camera alone is not asked."""
        if isinstance(self.mount, ImuMount):
            raise self.mount.question()
        return self.mount or (0.0, 0.0, 0.0)

    @property
    def known_mount(self) -> Mount | None:
        """As `mount_rpy_rad`, None where the camera itself is the body: no file states a mount then."""
        return None if self.mount is None else self.mount_rpy_rad


def read_calibration(
    path: Path,
    *,
    size: tuple[int, int] | None = None,
    name: str | None = None,
    imu_axes: str | None = None,
) -> Calibration:
    """A camera file of any known kind.

    In every kind these fields may stand beside the kind's own: `rotate_image` (90ccw, 90cw, 180: how the
    stored image is turned), `mount_rpy_deg` (the mount, in place of what the file says), `imu_axes` (of the
    IMU that the file leads to, or whose samples are the attitude, as flu), `use_camera` (which of several).

    Args:
        path: the file; `FILE#NAME` takes the camera of that name.
        size: width and height of the images, pixels, to choose among several cameras by.
        name: of the camera, or its topic.
        imu_axes: of the IMU that the file leads to, or whose samples are the attitude.

    Raises:
        InputError: not readable, of a kind or lens that is not known, a field is missing or wrong, several
            cameras fit.
    """
    if name is None and "#" in path.name and not path.exists():
        base, _, name = path.name.rpartition("#")
        path = path.with_name(base)
    fields = Fields(path, read_tree(path))
    _check_common(fields)
    turn = fields.text("rotate_image").lower() or "none"
    if turn not in QUARTER_TURNS_CCW:
        raise fields.wrong("rotate_image", "one of " + ", ".join(QUARTER_TURNS_CCW))
    upright = size[::-1] if size and QUARTER_TURNS_CCW[turn] % 2 else size
    wanted = Wanted(upright, name or fields.text("use_camera") or None)
    found, choice = choose(path, cameras_in(fields, wanted), wanted)
    axes = imu_axes or fields.text("imu_axes") or None
    if axes is not None:
        rotation_of_axes(axes, "--imu-axes" if imu_axes else path)
    mount = mount_of(fields, found, axes)
    return Calibration(found.camera, QUARTER_TURNS_CCW[turn], mount, (*found.notes, *choice), axes)


def _check_common(fields: Fields) -> None:
    """InputError for a field that looks like one of the common ones, and would be left out."""
    for name in fields.content:
        if name not in COMMON and _LIKE_COMMON.match(name):
            hint = f"known are {', '.join(COMMON)}"
            raise InputError(fields.path, f"has a field '{name[:40]}', which is not known here", hint)

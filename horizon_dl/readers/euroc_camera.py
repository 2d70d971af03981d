"""The camera of an ASL folder, and how it sits on the IMU, from whichever file is there."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from horizon_dl.calibration.calibration import Calibration, read_calibration
from horizon_dl.calibration.euroc import body_from_camera, sensor_camera
from horizon_dl.calibration.fields import Fields
from horizon_dl.calibration.tree import read_tree
from horizon_dl.data.given import Given
from horizon_dl.errors import InputError
from horizon_dl.geometry.attitude import OPTICAL_FROM_FRD, rotation_from_rpy
from horizon_dl.geometry.camera import Camera

Floats = NDArray[np.float64]

# Published rotations IMU to camera of the two data sets of this layout.
RIGS = {
    "EuRoC": [
        [0.0148655429818, 0.999557249008, -0.0257744366974],
        [-0.999880929698, 0.0149672133247, 0.00375618835797],
        [0.00414029679422, 0.025715529948, 0.999660727178],
    ],
    "TUM-VI": [
        [-0.9995250378696743, 0.029615343885863205, -0.008522328211654736],
        [0.0075019185074052044, -0.03439736061393144, -0.9993800792498829],
        [-0.02989013031643309, -0.998969345370175, 0.03415885127385616],
    ],
}
UPRIGHT = np.cos(np.deg2rad(50.0))
NEARLY_ALL = 0.9


@dataclass(frozen=True)
class EurocCamera:
    """A camera on the IMU.

    Attributes:
        camera: its intrinsics.
        cam_from_body: (3, 3) rotation of the IMU's axes into the optical frame.
        note: what was taken for want of a file, or nothing.
    """

    camera: Camera
    cam_from_body: Floats
    note: str = ""


def read_euroc_camera(root: Path, cam: Path, ups_body: Floats, given: Given) -> EurocCamera:
    """The camera from --camera, `sensor.yaml`, a camera.yaml or Kalibr's chain, in or beside the folders.

    Args:
        root: folder of all sensors.
        cam: folder of the camera.
        ups_body: (N, 3) the world's up in the IMU's axes; says which known rig may be meant.
        given: what the user gave.

    Raises:
        InputError: no calibration is there, or none that tells how the camera sits on the IMU.
    """
    path = given.camera or _find(root, cam)
    fields = Fields(path, read_tree(path))
    if "T_BS" in fields.content and "resolution" in fields.content:
        return EurocCamera(sensor_camera(fields), body_from_camera(fields).T)
    chained = isinstance(fields.content.get(cam.name), dict)
    calibration = read_calibration(path, name=cam.name if chained else None)
    stated = _stated(fields, cam.name, calibration)
    if stated is not None:
        return EurocCamera(calibration.camera, stated)
    sensor = cam / "sensor.yaml"
    if sensor.is_file() and "T_BS" in read_tree(sensor):
        return EurocCamera(calibration.camera, body_from_camera(Fields(sensor, read_tree(sensor))).T)
    name, rotation = _known_rig(path, cam, ups_body, calibration.camera)
    note = f"{path.name} does not say how the camera sits on the IMU: that of {name}'s own rig is taken"
    return EurocCamera(calibration.camera, rotation, note)


def _find(root: Path, cam: Path) -> Path:
    near = [place / name for place in (cam, root, root.parent) for name in ("sensor.yaml", "camera.yaml")]
    places = (root.parent / "dso", root, root.parent)
    chains = [path for place in places for path in sorted(place.glob("*camchain*.yaml"))]
    found = next((path for path in [*near, *chains] if path.is_file()), None)
    if found is None:
        raise InputError(cam / "sensor.yaml", "is missing", "copy it, or give a calibration with --camera")
    return found


def _stated(fields: Fields, cam: str, calibration: Calibration) -> Floats | None:
    """Rotation IMU to camera as the file states it, or None."""
    if "T_BS" in fields.content:
        return body_from_camera(fields).T
    inner = fields.content.get(cam) or fields.content.get("cam0")
    if isinstance(inner, dict) and "T_cam_imu" in inner:
        return np.array(inner["T_cam_imu"], np.float64).reshape(4, 4)[:3, :3]  # checked when it was read
    if fields.content.get("mount_rpy_deg") is not None:
        return OPTICAL_FROM_FRD @ rotation_from_rpy(*calibration.mount_rpy_rad).T
    return None


def _known_rig(path: Path, cam: Path, ups_body: Floats, camera: Camera) -> tuple[str, Floats]:
    """The one known rig on which the camera is upright in nearly all frames; InputError for none or both."""
    upright = {}
    for name, rows in RIGS.items():
        rotation = np.array(rows)
        if len(ups_body) and (-(ups_body @ rotation.T)[:, 1] > UPRIGHT).mean() >= NEARLY_ALL:
            upright[name] = rotation
    # Other rigs, too, have z up, as TUM-VI's; its pictures are square.
    if camera.width != camera.height:
        upright.pop("TUM-VI", None)
    if len(upright) != 1 or cam.name != "cam0":
        hint = "add T_BS (a sensor.yaml), Kalibr's T_cam_imu, or mount_rpy_deg"
        raise InputError(path, "does not say how the camera sits on the IMU", hint)
    return next(iter(upright.items()))

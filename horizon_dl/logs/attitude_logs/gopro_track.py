"""GoPro's own track in a film (GPMF): gravity where the camera gives it, else gyroscope and accelerometer."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from horizon_dl.data.attitude_log import AttitudeLog, Floats, angles_of_ups, log_of_angles
from horizon_dl.data.containers import opened, packets
from horizon_dl.data.tables.parsing import MOST_INERTIAL, by_time
from horizon_dl.errors import InputError
from horizon_dl.geometry.attitude import OPTICAL_FROM_FRD, rotation_from_quaternion
from horizon_dl.logs.attitude_logs.inertial import log_of_inertial
from horizon_dl.logs.attitude_logs.klv import Item, samples, spread, streams, text

NAME = "gopro"
NEEDS = "a GoPro film with its track of sensors, .mp4"
TRACK = "GoPro MET"

FRD_FROM_XYZ = np.array([[0.0, -1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, -1.0]])
"""From GoPro's sensor axes (X left, Y back, Z up) to forward, right, down."""
NO_GRAVITY = (
    "No gravity in this GoPro's track: the attitude is from gyroscope and accelerometer; "
    "look at the overlays."
)
ON_KARMA = (
    "The track has the attitude of a drone, too (ATTD): it is the body's, not the camera's, and is not used; "
    "the gimbal is taken to hold the camera, so expect an error of 2 degrees."
)
LEAST_GRAVITY = 0.5
"""Length of a gravity vector; some cameras write a track of zeros."""


@dataclass
class Stream:
    """One kind of samples over the whole film.

    Attributes:
        starts_s: of each packet.
        values: samples (n, k) of each packet.
        axes: order and sign of the sensors' axes, one letter each (ORIN), small letters negative.
    """

    starts_s: list[float] = field(default_factory=list)
    values: list[Floats] = field(default_factory=list)
    axes: str = ""

    def joined(self, end_s: float) -> tuple[Floats, Floats]:
        """Times (N,) s since the film began and samples (N, k)."""
        times_s = spread(self.starts_s, [len(one) for one in self.values], end_s)
        return times_s, np.concatenate(self.values)


def recognises(path: Path, head: bytes) -> bool:
    """Whether the file is a film of which a track has GoPro's name."""
    if head[4:8] != b"ftyp":
        return False
    try:
        with opened(path) as container:
            return any(TRACK in stream.metadata.get("handler_name", "") for stream in container.streams)
    except InputError:
        return False


def read(path: Path) -> AttitudeLog:
    """The camera's own attitude; seconds since the film's first picture.

    Gravity is turned by the image's orientation (IORI), which the stabilisation makes.

    Raises:
        InputError: the film has no such track, or neither gravity nor both inertial sensors in it.
    """
    found, end_s = read_streams(path, ("GRAV", "IORI", "ACCL", "GYRO", "ATTD"))
    if "GRAV" in found:
        times_s, down = found["GRAV"].joined(end_s)
        if np.median(np.linalg.norm(down, axis=1)) > LEAST_GRAVITY:
            return _of_gravity(times_s, down, found.get("IORI"), end_s)
    if not {"ACCL", "GYRO"} <= set(found):
        problem = "has no gravity, and not both of gyroscope and accelerometer"
        raise InputError(path, problem, "give another log with --attitude")
    gyro, accelerometer = (_in_body(found[key], end_s) for key in ("GYRO", "ACCL"))
    karma = "ATTD" in found  # a drone's own attitude: the camera hangs in its gimbal and has another
    log = log_of_inertial(gyro, accelerometer, np.eye(3), gimbal=karma)
    return AttitudeLog(log.times_s, log.quaternions, notes=(NO_GRAVITY, *((ON_KARMA,) if karma else ())))


def read_streams(path: Path, keys: Sequence[str]) -> tuple[dict[str, Stream], float]:
    """The streams of some keys, and the end of the track, s since the film's first picture.

    Raises:
        InputError: it is no film, or a film without GoPro's track.
    """
    found: dict[str, Stream] = {}
    end_s = 0.0
    with opened(path) as container:
        tracks = [one for one in container.streams if TRACK in one.metadata.get("handler_name", "")]
        if not tracks:
            raise InputError(path, "has no track of a GoPro's sensors", "give a log with --attitude")
        video = container.streams.video[0]
        start_s = float((video.start_time or 0) * video.time_base)
        for packet in packets(container, tracks[0]):
            if packet.pts is None:
                continue
            time_s = float(packet.pts * packet.time_base) - start_s
            end_s = time_s + float((packet.duration or 0) * packet.time_base)
            for stream in streams(bytes(packet)):
                for key in set(keys) & set(stream):
                    _add(found, key, stream, time_s)
    return found, end_s


def _add(found: dict[str, Stream], key: str, stream: dict[str, Item], time_s: float) -> None:
    values = samples(stream, key)
    if len(values):
        one = found.setdefault(key, Stream())
        one.starts_s.append(time_s)
        one.values.append(values)
        one.axes = text(stream, "ORIN") or "ZXY"


def _in_body(stream: Stream, end_s: float) -> tuple[Floats, Floats]:
    """Times and samples in forward, right, down."""
    times_s, values = stream.joined(end_s)
    order = [stream.axes.upper().index(axis) for axis in "XYZ"]
    signs = [1.0 if stream.axes[place].isupper() else -1.0 for place in order]
    return by_time(times_s, np.asarray(values[:, order] * signs @ FRD_FROM_XYZ.T), MOST_INERTIAL)


def _of_gravity(times_s: Floats, down: Floats, orientation: Stream | None, end_s: float) -> AttitudeLog:
    """Gravity (down) in optical axes, turned into the picture as it was stabilised."""
    if orientation is not None:
        turn_times_s, turns = orientation.joined(end_s)
        nearest = np.clip(np.searchsorted(turn_times_s, times_s - 1e-6), 0, len(turns) - 1)
        turned = [
            rotation_from_quaternion(turn) @ one if np.any(turn) else one
            for turn, one in zip(turns[nearest], down, strict=True)
        ]
        down = np.array(turned)
    log = log_of_angles(times_s, angles_of_ups(-down @ OPTICAL_FROM_FRD), has_yaw=False)
    note = "GoPro's gravity track; its axes were checked on a MAX alone: look at the overlays."
    return AttitudeLog(log.times_s, log.quaternions, has_yaw=False, notes=(note,))

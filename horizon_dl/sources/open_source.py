"""One door for everything that frames come from: recordings of every format, cameras, streams."""

from collections.abc import Callable
from pathlib import Path

from horizon_dl.calibration.calibration import read_calibration
from horizon_dl.data.given import CONSTANT, MAVLINK, NOTHING_GIVEN, Given
from horizon_dl.data.source import FrameSource, Recording
from horizon_dl.errors import InputError
from horizon_dl.logs.attitude_logs.registry import constant_attitude
from horizon_dl.logs.clock.align import on_found_clock
from horizon_dl.readers.registry import open_recording
from horizon_dl.sources.camera import CameraSource, is_live
from horizon_dl.sources.with_autopilot import WithAutopilot
from horizon_dl.vehicle.mavlink import Link, open_link


def open_source(
    where: str | Path,
    format: str | None = None,
    given: Given = NOTHING_GIVEN,
    *,
    delay_s: float = 0.0,
    link: Callable[[str], Link] = open_link,
) -> FrameSource:
    """The frames of a file, a folder, a camera (`camera:0`) or a stream's address.

    Args:
        where: see above.
        format: name of the reader; None: recognised by content.
        given: what the data lacks.
        delay_s: of a camera, from exposure to arrival.
        link: opens the line to an autopilot, whose address is the attitude `mavlink:URL` of a camera.

    Raises:
        InputError: there is nothing, or nothing that can be read; the error says how to give what lacks.

    Example:
        >>> source = open_source("flight/")                        # doctest: +SKIP
        >>> for frame in source.frames(): ...                      # doctest: +SKIP
    """
    if not is_live(str(where)):
        return open_finished(where, format, given)
    if given.needs_attitude and given.attitude is None:
        problem = "has no attitude: nothing says where the horizon lies"
        raise InputError(where, problem, "give --attitude mavlink:URL, or constant:ROLL,PITCH in degrees")
    calibration = None if given.camera is None else read_calibration(given.camera, imu_axes=given.imu_axes)
    if given.attitude is not None and given.attitude.startswith(MAVLINK):
        if calibration is None:
            raise InputError("--camera", "is missing", "name the calibration that holds the mount")
        url = given.attitude.removeprefix(MAVLINK)
        return WithAutopilot(CameraSource(str(where), calibration, delay_s=delay_s), lambda: link(url))
    if given.attitude is not None and not given.attitude.startswith(CONSTANT):
        problem = "is no attitude of a camera: a log is of a recording"
        raise InputError(f"--attitude {given.attitude}", problem, "give mavlink:URL or constant:ROLL,PITCH")
    attitude = None if given.attitude is None else constant_attitude(given.attitude)
    return CameraSource(str(where), calibration, delay_s=delay_s, attitude=attitude)


def open_finished(where: str | Path, format: str | None = None, given: Given = NOTHING_GIVEN) -> Recording:
    """As `open_source`, of what can be read again and again; InputError for a camera or stream."""
    if is_live(str(where)):
        raise InputError(where, "is live: its frames are gone once seen", "learn from it with `online`")
    recording = open_recording(Path(where), format, given)
    return on_found_clock(recording) if given.find_offset else recording

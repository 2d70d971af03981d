"""Roll and pitch from the pictures themselves, `--attitude from-images`: where nothing else tells them."""

from dataclasses import replace
from math import degrees, radians

import numpy as np
from PIL import Image

from horizon_dl.data.frame import Frame, FrameHeader
from horizon_dl.data.given import Given
from horizon_dl.data.source import Recording
from horizon_dl.errors import FrameError, InputError
from horizon_dl.geometry.horizon_line import up_from_colours
from horizon_dl.geometry.lines import line_planes
from horizon_dl.geometry.manhattan import up_from_edges
from horizon_dl.geometry.rays import camera_rays
from horizon_dl.geometry.tilts import UpEstimate
from horizon_dl.progress import show_progress

FROM_IMAGES = "from-images"
MOST_DOUBT_RAD = radians(4.0)
"""With more doubt a picture's attitude is not known."""
COLOUR_PIXELS = 1600
BAR_FROM = 100


def camera_alone(given: Given) -> Given:
    """What is to be given to a reader so that it takes the camera and asks for no attitude."""
    return replace(given, attitude="constant:0,0", needs_attitude=False)


def with_attitude_from_images(recording: Recording) -> Recording:
    """The recording with the attitudes that its pictures tell, unknown where they leave too much doubt.

    All pictures are looked at once.

    Raises:
        InputError: the camera is not known, or no picture tells.
    """
    if recording.camera is None:
        raise InputError(f"--attitude {FROM_IMAGES}", "needs to know the camera", "give --camera FILE")
    headers: list[FrameHeader] = []
    doubts = []
    everything = show_progress(
        range(recording.length),
        "attitudes from the pictures",
        unit="frame",
        disable=recording.length < BAR_FROM,
    )
    for index in everything:
        found = _estimate(recording, index)
        known = found is not None and found.sd_rad <= MOST_DOUBT_RAD
        if found is not None and known:
            doubts.append(found.sd_rad)
        up_cam = found.up_cam if found is not None and known else None
        headers.append(replace(recording.headers[index], up_cam=up_cam, yaw_rad=None, floor_up_cam=None))
    if not doubts:
        raise InputError(
            recording.name,
            "its pictures do not tell how the camera is held: no upright edges and no open horizon",
            "give --attitude FILE or --attitude constant:ROLL,PITCH",
        )
    note = (
        f"roll and pitch are from the pictures, in {len(doubts)} of {recording.length}, "
        f"with a doubt of {degrees(float(np.median(doubts))):.1f} degrees and errors of more"
    )
    return replace(recording, headers=headers, mount_rpy_rad=None, notes=(*recording.notes, note))


def up_from_picture(frame: Frame) -> UpEstimate | None:
    """By edges or by the line between sky and sea, whichever leaves less doubt; None where neither tells."""
    camera = frame.calibrated
    small = camera.reduced(COLOUR_PIXELS)
    shrunk = Image.fromarray(frame.image).resize((small.width, small.height), Image.Resampling.BOX)
    found = (
        up_from_edges(line_planes(frame.image, camera)),
        up_from_colours(np.asarray(shrunk), camera_rays(small).directions),
    )
    return min((one for one in found if one is not None), key=lambda one: one.sd_rad, default=None)


def _estimate(recording: Recording, index: int) -> UpEstimate | None:
    try:
        return up_from_picture(recording.read(index, with_truth=False))
    except FrameError:
        return None

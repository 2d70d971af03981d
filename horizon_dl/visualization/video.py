"""A film of a flight: free ground, distance per bearing and the chosen heading, frame by frame."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from horizon_dl.data.source import Recording
from horizon_dl.errors import FrameError, InputError
from horizon_dl.runtime.perception import PictureModel, model_rays
from horizon_dl.visualization.colours import Image
from horizon_dl.visualization.range_picture import range_picture

FASTEST_HZ = 60.0


def write_film(path: Path, model: PictureModel, recording: Recording) -> int:
    """Write a flight as an MP4 at its own rate; needs OpenCV.

    Args:
        path: of the file; it is written beside and renamed.
        model: exported for the recording's camera.
        recording: with attitudes; frames without are left out.

    Returns:
        How many frames were written.

    Raises:
        InputError: no frame can be used, or no file can be written.
    """
    import cv2

    beside = path.with_name(f".{path.stem}.part.mp4")
    writer, count = None, 0
    try:
        for picture in drawn_frames(model, recording):
            if writer is None:
                size = (picture.shape[1], picture.shape[0])
                codec = cv2.VideoWriter.fourcc(*"mp4v")
                writer = cv2.VideoWriter(str(beside), codec, frames_per_second(recording), size)
                if not writer.isOpened():
                    raise InputError(
                        path, "cannot be written as a film", "give a .mp4 in a folder that exists"
                    )
            writer.write(cv2.cvtColor(picture, cv2.COLOR_RGB2BGR))
            count += 1
        if writer is None:
            raise InputError(
                recording.name, "holds no frame with attitude that can be read", "see check-data"
            )
        writer.release()
        beside.replace(path)
    finally:
        beside.unlink(missing_ok=True)
    return count


def drawn_frames(model: PictureModel, recording: Recording) -> Iterator[Image]:
    """Every usable frame, drawn at the model's working size (even sides); zero is the optical axis."""
    rays = model_rays(model)
    height, width = (side - side % 2 for side in rays.shape[:2])
    for index in range(recording.length):
        try:
            frame = recording.read(index)
        except FrameError:
            continue
        if frame.up_cam is not None:
            p_above = model.predict(frame.image, frame.up_cam).p_above
            drawn = range_picture(frame, rays, p_above, model.threshold, model.place)
            if drawn is not None:
                yield drawn[:height, :width]


def frames_per_second(recording: Recording) -> float:
    """The recording's median rate, at most 60; 10 where it cannot be told."""
    times = np.array([entry.time_s for entry in recording.headers])
    period_s = float(np.median(np.diff(times))) if len(times) > 1 else 0.1
    return min(FASTEST_HZ, 1.0 / period_s) if period_s > 0 else 10.0

"""The camera's turns as seen in a recording's pictures, over a frame and over several."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from horizon_dl.data.source import Recording
from horizon_dl.errors import FrameError
from horizon_dl.inspection.image_rotation import rotation_between
from horizon_dl.progress import show_progress

Floats = NDArray[np.float64]

PIXELS = 76800
WINDOWS, WINDOW = 12, 9
SPANS = (1, 2, 4, 8)
"""Frames between two pictures: what a slow camera does shows over several."""


@dataclass(frozen=True)
class Turns:
    """Rotations between pairs of frames.

    Attributes:
        first, second: (P,) indices of the frames.
        rotation: (P, 3, 3) takes directions in the first optical frame to the second.
        window: (P,) number of the stretch of the recording that a pair lies in.
        looked_at: pairs of successive pictures that were compared.
    """

    first: NDArray[np.int64]
    second: NDArray[np.int64]
    rotation: Floats
    window: NDArray[np.int64]
    looked_at: int

    def select(self, pairs: NDArray[np.bool_]) -> "Turns":
        """Some of the pairs."""
        return Turns(
            self.first[pairs], self.second[pairs], self.rotation[pairs], self.window[pairs], self.looked_at
        )


def window_indices(length: int, motion: Floats | None = None) -> list[list[int]]:
    """Stretches of successive frames that do not overlap: evenly spread, or where there is most motion.

    Args:
        length: number of frames.
        motion: (length - 1,) from each frame to the next, in any unit; 0 where it is not known.

    Example:
        >>> [len(one) for one in window_indices(20)]
        [9, 9, 2]
    """
    if length <= WINDOWS * WINDOW:
        return [list(range(start, min(start + WINDOW, length))) for start in range(0, length, WINDOW)]
    if motion is None or not motion.any():
        starts = np.linspace(0, length - WINDOW, WINDOWS).round().astype(int).tolist()
    else:
        places = np.arange(0, length - WINDOW + 1, WINDOW)
        moved = np.array([motion[place : place + WINDOW - 1].sum() for place in places])
        starts = sorted(places[np.argsort(-moved, kind="stable")[:WINDOWS]].tolist())
    return [list(range(start, start + WINDOW)) for start in starts]


def logged_motion(recording: Recording) -> Floats | None:
    """Turn (N - 1,) from each frame to the next by the attitude's numbers, 0 where they are not known.

    How far an attitude turns is the same however its axes are read, and nearly so for quaternions in the
    wrong order. None where no numbers are kept.
    """
    width = next((len(one.as_read) for one in recording.headers if one.as_read is not None), 0)
    if recording.reading is None or not width:
        return None
    numbers = np.array([one.as_read or (np.nan,) * width for one in recording.headers], np.float64)
    rotations = recording.reading.convention.rotations(numbers)
    traces = np.einsum("nij,nij->n", rotations[:-1], rotations[1:])
    return np.asarray(np.nan_to_num(np.arccos(np.clip((traces - 1) / 2, -1.0, 1.0))))


def measure_turns(recording: Recording, *, progress: bool = False) -> Turns:
    """Turns between the frames of the liveliest 12 stretches of 9; pairs that cannot be told are left out."""
    windows = window_indices(recording.length, logged_motion(recording))
    rows: list[tuple[int, int, int, Floats]] = []
    looked_at = 0
    for number, window in enumerate(
        show_progress(windows, "following the pictures", unit="piece", disable=not progress)
    ):
        steps = _steps(recording, window)
        looked_at += len(steps)
        for span in SPANS:
            for start in range(len(window) - span):
                turn: Floats | None = np.eye(3)
                for step in steps[start : start + span]:
                    turn = None if turn is None or step is None else step @ turn
                if turn is not None:
                    rows.append((window[start], window[start + span], number, turn))
    first, second, number_of = (np.array([row[k] for row in rows], np.int64) for k in range(3))
    rotation = np.array([row[3] for row in rows]).reshape(-1, 3, 3)
    return Turns(first, second, rotation, number_of, looked_at)


def _steps(recording: Recording, window: list[int]) -> list[Floats | None]:
    """The turn from each picture to the next."""
    camera = recording.calibrated.reduced(PIXELS)
    size = camera.width, camera.height
    pictures: list[NDArray[np.uint8] | None] = []
    for index in window:
        try:
            image = recording.read(index, with_truth=False).image
        except FrameError:
            pictures.append(None)
            continue
        grey = Image.fromarray(image).convert("L").resize(size, Image.Resampling.BOX)
        pictures.append(np.asarray(grey, np.uint8))
    return [
        None if one is None or other is None else rotation_between(camera, one, other)
        for one, other in pairwise(pictures)
    ]

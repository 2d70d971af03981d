"""Pictures for the onboard loop: a camera, a video, or a recorded set replayed in real time.

Times are those of the caller's clock. The newest picture wins: a slow model skips pictures and never lags
behind.
"""

import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from horizon_dl.data.frame import Recording
from horizon_dl.data.images import load_frame
from horizon_dl.errors import FrameError, InputError

Clock = Callable[[], float]

CAMERA_PREFIX = "camera:"
REOPEN_S = 0.5
"""A camera or stream that gave no picture is opened again after this time."""


@dataclass(frozen=True)
class Picture:
    """One picture to be looked at.

    Attributes:
        time_s: when it was taken, by the caller's clock.
        image: (H, W, 3) uint8 RGB, upright.
        up_cam: (3,) as recorded, or None: the autopilot's attitude is asked for.
        height_m: as recorded, or None.
        floor_up_cam: (3,) the floor's normal where it is known to differ from `up_cam`, as under a car.
    """

    time_s: float
    image: NDArray[np.uint8]
    up_cam: NDArray[np.float64] | None = None
    height_m: float | None = None
    floor_up_cam: NDArray[np.float64] | None = None


def is_live(source: str) -> bool:
    """Whether a source is a camera or a stream's address, and no file or folder."""
    return source.startswith(CAMERA_PREFIX) or "://" in source


def replay(
    recording: Recording,
    clock: Clock,
    *,
    speed: float = 1.0,
    loop: bool = False,
    wait: Callable[[float], object] = time.sleep,
) -> Iterator[Picture]:
    """The frames of a set at the times at which they were taken; those that cannot be read are left out.

    Args:
        recording: with attitudes, and heights if distances are wanted.
        clock: monotonic seconds.
        speed: 2 plays twice as fast.
        loop: begin again at the end; the time of one frame passes between.
        wait: sleeps for some seconds.

    Raises:
        InputError: not one frame can be read.
    """
    times = [entry.time_s for entry in recording.entries]
    gap_s = float(np.median(np.diff(times))) if len(times) > 1 else 0.1
    start_s = clock()
    any_read = False
    while True:
        for index, taken_s in enumerate(times):
            try:
                frame = load_frame(recording, index)
            except FrameError:
                continue
            any_read = True
            due_s = start_s + (taken_s - times[0]) / speed
            wait(max(0.0, due_s - clock()))
            # The time at which it was taken, however late it was read: that time's attitude belongs to it.
            yield Picture(due_s, frame.image, frame.up_cam, frame.height_m, frame.floor_up_cam)
        if not any_read:
            raise InputError(recording.name, "has no frame that can be read", "check its images")
        if not loop:
            return
        start_s += (times[-1] - times[0] + gap_s) / speed


class Stoppable(Iterator[Picture]):
    """Pictures that end soon after `stop`, from any thread, even while none come."""

    def __init__(self, pictures: Iterator[Picture], stopped: threading.Event) -> None:
        self._pictures, self._stopped = pictures, stopped

    def __next__(self) -> Picture:
        return next(self._pictures)

    def stop(self) -> None:
        """No more are wanted."""
        self._stopped.set()


def capture(
    source: str,
    clock: Clock,
    *,
    rotate_quarter_turns_ccw: int = 0,
    delay_s: float = 0.0,
    wait: Callable[[float], object] = time.sleep,
) -> Stoppable:
    """Pictures of a camera (`camera:0`), a stream's address, or a video file at its own rate, by OpenCV.

    A file ends. A camera or stream that fails is opened again and again until it gives pictures.

    Args:
        source: see above.
        clock: monotonic seconds.
        rotate_quarter_turns_ccw: how pictures are turned to be upright.
        delay_s: from exposure to arrival; the pictures' times are their arrivals' minus this.
        wait: sleeps for some seconds.

    Raises:
        InputError: OpenCV cannot open it, when the first picture is asked for.
    """
    import cv2

    stopped = threading.Event()

    def pictures() -> Iterator[Picture]:
        due_s = clock()
        for period_s, image in _images(source, stopped):
            wait(max(0.0, due_s - clock()))
            due_s += period_s
            rgb = np.rot90(cv2.cvtColor(image, cv2.COLOR_BGR2RGB), rotate_quarter_turns_ccw)
            yield Picture(clock() - delay_s, np.ascontiguousarray(rgb))

    return Stoppable(pictures(), stopped)


def _images(source: str, stopped: threading.Event) -> Iterator[tuple[float, Any]]:
    """Images of OpenCV, BGR, and the time that each one lasts, s; 0 for a camera, whose images are due."""
    import cv2

    is_film = Path(source).is_file()
    opened = _open(source)
    if not opened.isOpened():
        raise InputError(
            f"--source {source}", "cannot be opened", "give camera:0, a video file or a data set"
        )
    period_s = 1.0 / (opened.get(cv2.CAP_PROP_FPS) or 30.0) if is_film else 0.0
    try:
        while not stopped.is_set():
            good, image = opened.read()
            if good:
                yield period_s, image
            elif is_film:
                return
            else:
                opened.release()  # a device is opened only once at a time
                stopped.wait(REOPEN_S)
                opened = _open(source)
    finally:
        opened.release()


def _open(source: str) -> Any:
    """OpenCV's object for a source; it says by itself whether it is open."""
    import cv2

    device = source.removeprefix(CAMERA_PREFIX)
    return cv2.VideoCapture(int(device) if device != source and device.isdigit() else device)


class LatestPicture:
    """A slot for one picture, filled by a thread; what is not taken in time is overwritten and counted.

    Attributes:
        ended: the source has no more.
        error: why the source ended, or None.
        seen: pictures that came.
        skipped: pictures that were overwritten.
    """

    def __init__(self, pictures: Iterator[Picture], on_picture: Callable[[], None]) -> None:
        self.ended = False
        self.error: Exception | None = None
        self.seen = self.skipped = 0
        self._pictures = pictures
        self._on_picture = on_picture
        self._slot: Picture | None = None
        self._filled = threading.Condition()
        self._stopped = False
        self._thread = threading.Thread(target=self._fill, name="pictures", daemon=True)

    def start(self) -> None:
        """Begin to read."""
        self._thread.start()

    def take(self, timeout_s: float) -> Picture | None:
        """The newest picture not taken before, or None after the timeout."""
        with self._filled:
            self._filled.wait_for(lambda: self._slot is not None or self.ended, timeout_s)
            picture, self._slot = self._slot, None
            return picture

    def stop(self) -> None:
        """Read no more."""
        self._stopped = True
        if isinstance(self._pictures, Stoppable):
            self._pictures.stop()
        self._thread.join(1.0)

    def _fill(self) -> None:
        try:
            for picture in self._pictures:
                if self._stopped:
                    break
                self._on_picture()
                with self._filled:
                    self.seen += 1
                    self.skipped += self._slot is not None
                    self._slot = picture
                    self._filled.notify()
        except Exception as error:  # whatever a camera's driver raises: the loop has to learn of it
            self.error = error
        with self._filled:
            self.ended = True
            self._filled.notify()

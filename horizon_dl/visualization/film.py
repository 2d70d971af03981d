"""A sink that writes a film that browsers play: H.264 in an MP4, at the pace of the frames' own times.

Ten pictures a second at most.
"""

import math
from fractions import Fraction
from pathlib import Path
from typing import Any

from horizon_dl.data.frame import Frame
from horizon_dl.errors import InputError
from horizon_dl.runtime.prediction import Prediction
from horizon_dl.runtime.ranged import Ranged
from horizon_dl.visualization.cells import resize_image
from horizon_dl.visualization.film_picture import FilmPicture
from horizon_dl.visualization.panels import image_bytes

TICKS = 1000
PLAIN_S = 0.5
"""Each of a folder of plain pictures is shown so long."""
LONGEST_S, SHORTEST_S = 1.0, 1 / 60
"""A longer gap between two frames would look like a film that hangs; a shorter one no screen shows."""
POSTER_FRAME = 12
MOST_HZ = 10.0
"""Of a faster source frames are left out: to draw a picture takes ten times as long as to predict it."""


class Film:
    """Writes as it goes; what a killed process leaves can be played up to its last second or two.

    Args:
        path: of the file.
        with_ground: see `FilmPicture`.
        timed: the frames' times mean something, as those of plain pictures do not.

    Attributes:
        path: of the file.
        frames: that were written.
        poster: a picture from the film's beginning, as a JPEG; empty before there is one.

    Raises:
        ModuleNotFoundError: PyAV, of the extra `logs`, is not installed.
    """

    def __init__(self, path: Path, with_ground: bool = True, timed: bool = True) -> None:
        import av

        self.path, self.frames, self.poster = path, 0, b""
        self._av: Any = av
        self._picture = FilmPicture(with_ground)
        self._timed = timed
        self._container: Any = None
        self._stream: Any = None
        self._last_s = self._due_s = -math.inf
        self._shown_s = 0.0

    def log(self, frame: Frame, prediction: Prediction, ranges: Ranged | None) -> None:
        """See `Sink`."""
        if frame.time_s < self._last_s:
            self._due_s = -math.inf
        if self._timed and frame.time_s < self._due_s:
            return
        self._due_s = max(self._due_s, frame.time_s - 0.5 / MOST_HZ) + 1 / MOST_HZ
        picture = self._picture(frame, prediction, ranges)
        if self.frames in (0, POSTER_FRAME):
            self.poster = image_bytes(
                resize_image(picture, 960, 960 * picture.shape[0] // picture.shape[1]), "JPEG"
            )
        if self._container is None:
            self._open(picture.shape[1], picture.shape[0])
        else:
            self._shown_s += self._gap_s(frame.time_s)
        self._last_s = frame.time_s
        encoded = self._av.VideoFrame.from_ndarray(picture, format="rgb24")
        encoded.pts, encoded.time_base = round(self._shown_s * TICKS), Fraction(1, TICKS)
        self._write(self._stream.encode(encoded))
        self.frames += 1

    def close(self) -> None:
        """Write the last pictures; a film without any leaves no file."""
        if self._container is not None:
            self._write(self._stream.encode())
            self._container.close()
            self._container = None

    def _open(self, width: int, height: int) -> None:
        # Fragments: a film that is cut off by a crash still plays.
        options = {"movflags": "frag_keyframe+empty_moov+default_base_moof"}
        self._container = self._av.open(str(self.path), "w", format="mp4", options=options)
        # A nominal rate for the encoder; the frames' own times are what is played.
        self._stream = self._container.add_stream("libx264", rate=30)
        self._stream.width, self._stream.height, self._stream.pix_fmt = width, height, "yuv420p"
        self._stream.codec_context.time_base = Fraction(1, TICKS)
        self._stream.options = {"crf": "23", "preset": "superfast", "tune": "zerolatency", "g": "30"}

    def _gap_s(self, time_s: float) -> float:
        gap_s = time_s - self._last_s
        if not self._timed or not math.isfinite(gap_s):
            return PLAIN_S
        return min(max(gap_s, SHORTEST_S), LONGEST_S)

    def _write(self, packets: Any) -> None:
        try:
            for packet in packets:
                self._container.mux(packet)
        except OSError as error:
            problem = f"cannot be written as a film ({error.strerror or error})"
            raise InputError(self.path, problem, "give a folder that exists, with room in it") from None

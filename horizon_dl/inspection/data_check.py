"""Whether a recording can work: figures over all entries and sampled images, findings and a verdict."""

import math
from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from horizon_dl.data.evenly import evenly
from horizon_dl.data.frame import FrameHeader, has_attitude
from horizon_dl.data.source import Recording
from horizon_dl.data.view import View, make_view
from horizon_dl.errors import FrameError, InputError
from horizon_dl.evidence.sketch import luma
from horizon_dl.geometry.camera import working_size
from horizon_dl.inspection.check_result import DataCheck
from horizon_dl.inspection.findings import with_findings
from horizon_dl.inspection.image_quality import (
    PictureStatistics,
    TruthStatistics,
    exposure,
    picture_statistics,
    truth_counts,
    truth_statistics,
)
from horizon_dl.inspection.orientation import check_orientation
from horizon_dl.inspection.time_offset import MotionFit, measured_shift, motion_fit, predicted_shifts
from horizon_dl.inspection.timing_and_attitude import (
    Timing,
    attitudes,
    label_statistics,
    percentiles,
    timing,
)
from horizon_dl.logs.clock.find_clock import find_clock
from horizon_dl.progress import show_progress

OVERLAYS = 8
MOST_TRUTHS = 30
MOTION_PIXELS = 38400


@dataclass
class _Sample:
    """What the sampled images gave so far."""

    pictures: list[PictureStatistics] = field(default_factory=list)
    levels: list[float] = field(default_factory=list)
    followers: int = 0
    pairs: list[int] = field(default_factory=list)
    shifts: list[tuple[float, float]] = field(default_factory=list)
    unreadable: list[tuple[str, str]] = field(default_factory=list)
    views: list[tuple[FrameHeader, View]] = field(default_factory=list)
    truth: NDArray[np.int64] = field(default_factory=lambda: np.zeros(5, np.int64))


def sample_indices(count: int, most: int) -> list[int]:
    """At most about `most` evenly spaced indices; pairs of neighbours where not all fit, to see motion.

    Example:
        >>> sample_indices(5, 10), sample_indices(100, 4)
        ([0, 1, 2, 3, 4], [0, 1, 98, 99])
    """
    if count <= most:
        return list(range(count))
    starts = np.linspace(0, count - 2, max(1, most // 2)).round().astype(int)
    return sorted({int(index) for start in starts for index in (start, start + 1)})


def check_recording(
    recording: Recording,
    *,
    band_rad: float = math.radians(2.0),
    max_pixels: int = 320 * 240,
    max_frames: int = 200,
    orientation: bool = False,
    progress: bool = False,
) -> DataCheck:
    """Looks at a recording: all entries for times and attitudes, at most `max_frames` images for pixels.

    Args:
        recording: of any format.
        band_rad: half width of the ignored band around the horizon, rad.
        max_pixels: size at which images are looked at.
        max_frames: images that are read, evenly spaced.
        orientation: find out by which convention the attitude is to be read, and the mount; reads up to 190
            images more.
        progress: show a bar.

    Raises:
        InputError: the recording has no frames.

    Example:
        >>> check = check_recording(open_recording(Path("data/hallway")))  # doctest: +SKIP
        >>> check.verdict  # doctest: +SKIP
        'This data can work.'
    """
    if not recording.headers:
        raise InputError(recording.name, "has no frames", "check the folder and its image list")
    times = timing(recording.headers)
    indices = sample_indices(recording.length, max_frames)
    sample = _look(recording, indices, max_pixels, progress)
    heights = [entry.height_m for entry in recording.headers if entry.height_m is not None]
    labelled = [index for index, entry in enumerate(recording.headers) if entry.labelled]
    check = DataCheck(
        name=recording.name,
        format=recording.format,
        frames=recording.length,
        sampled=len(indices),
        unreadable=len(sample.unreadable),
        unreadable_examples=tuple(sample.unreadable[:5]),
        band_deg=math.degrees(band_rad),
        notes=tuple(recording.notes),
        timing=times,
        attitudes=attitudes(recording.headers),
        labels=label_statistics(recording, band_rad),
        exposure=exposure(sample.pictures, sample.levels, sample.followers),
        motion=_motion(recording, sample, times),
        clock=find_clock(recording),
        height_m=percentiles(np.array(heights)) if heights else None,
        truth=_truth(recording, labelled) if labelled else None,
        orientation=check_orientation(recording, progress=progress) if orientation else None,
        overlay_views=tuple(sample.views),
    )
    return with_findings(check)


def _look(recording: Recording, indices: list[int], max_pixels: int, progress: bool) -> _Sample:
    """Reads the sampled images once; those that cannot be read are noted and left out."""
    sample = _Sample()
    overlays = set(evenly(indices, OVERLAYS))
    size = working_size(recording.calibrated.width, recording.calibrated.height, max_pixels)
    before: tuple[int, NDArray[np.uint8]] | None = None
    for index in _bar(indices, progress):
        try:
            frame = recording.read(index)
        except FrameError as error:
            sample.unreadable.append((recording.headers[index].name, str(error)))
            continue
        image = np.asarray(Image.fromarray(frame.image).resize(size, Image.Resampling.BOX), np.uint8)
        previous = before[1] if before is not None and before[0] == index - 1 else None
        _measure(sample, index, image, previous)
        if index in overlays and has_attitude(frame):
            sample.views.append((recording.headers[index], make_view(frame, max_pixels)))
        before = (index, image)
    return sample


def _measure(
    sample: _Sample, index: int, image: NDArray[np.uint8], previous: NDArray[np.uint8] | None
) -> None:
    sample.pictures.append(picture_statistics(image, previous))
    sample.levels.append(float(luma(image).mean()))
    if previous is None:
        return
    sample.followers += 1
    height, width = image.shape[:2]
    scale = min(1.0, math.sqrt(MOTION_PIXELS / (height * width)))
    small = max(16, int(width * scale)), max(16, int(height * scale))
    pair = [
        luma(np.asarray(Image.fromarray(one).resize(small, Image.Resampling.BOX)))
        for one in (previous, image)
    ]
    # In parts of the image's height, so that any size can be predicted for.
    left, right = (shift / small[1] for shift in measured_shift(pair[0], pair[1]))
    sample.pairs.append(index - 1)
    sample.shifts.append((left, right))


def _motion(recording: Recording, sample: _Sample, times: Timing) -> MotionFit | None:
    camera = recording.calibrated.reduced(MOTION_PIXELS)
    if not sample.pairs or camera.height < 16:
        return None
    return motion_fit(
        np.array(sample.shifts) * camera.height,
        np.array(sample.pairs),
        predicted_shifts(recording.headers, camera),
        1.0 / times.rate_hz if times.rate_hz else None,
        camera.height,
    )


def _truth(recording: Recording, labelled: list[int]) -> TruthStatistics:
    """Truths of at most `MOST_TRUTHS` evenly spaced labelled frames; unreadable ones count as not read."""
    counts = np.zeros(5, np.int64)
    for index in evenly(labelled, MOST_TRUTHS):
        try:
            counts += truth_counts(recording.read(index))
        except FrameError:
            continue
    return truth_statistics(len(labelled), counts)


def _bar(indices: list[int], progress: bool) -> Iterable[int]:
    bar: Iterable[int] = show_progress(indices, "looking at images", unit="image", disable=not progress)
    return bar

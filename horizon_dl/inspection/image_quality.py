"""What the images themselves tell: exposure, sharpness, frozen frames, and agreement with the labels."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from horizon_dl.data.frame import Frame, Truth
from horizon_dl.evidence.exposure import exposure_problem
from horizon_dl.evidence.reason import Reason
from horizon_dl.evidence.sketch import luma, same_picture, sketch_of
from horizon_dl.geometry.horizon import elevation


@dataclass(frozen=True)
class PictureStatistics:
    """One image at the working size.

    Attributes:
        problem: why the exposure shows nothing, or None.
        sharpness: mean absolute Laplacian over the contrast; falls with motion blur.
        frozen: whether the image equals the one right before it.
    """

    problem: Reason | None
    sharpness: float
    frozen: bool


@dataclass(frozen=True)
class Exposure:
    """Shares of the sampled images."""

    too_dark: float
    overexposed: float
    without_contrast: float
    frozen: float
    blurred: float
    median_level: float


@dataclass(frozen=True)
class TruthStatistics:
    """Truth labels: how many frames have them, and how they agree with the horizon.

    `floor_above_horizon` is the share of the floor's pixels that lie above the horizon by more than a degree:
    a floor seen there means that attitude, mount or camera are wrong. Shares are of the labelled pixels.
    """

    labelled_frames: int
    read_frames: int
    floor: float
    obstacle: float
    above: float
    floor_above_horizon: float


def picture_statistics(image: NDArray[np.uint8], previous: NDArray[np.uint8] | None) -> PictureStatistics:
    """Statistics of an (h, w, 3) image; `previous` is the image right before it where that was read, too."""
    level = luma(image)
    laplacian = (
        4 * level[1:-1, 1:-1] - level[:-2, 1:-1] - level[2:, 1:-1] - level[1:-1, :-2] - level[1:-1, 2:]
    )
    contrast = float(level.std())
    return PictureStatistics(
        problem=exposure_problem(level),
        sharpness=float(np.abs(laplacian).mean()) / max(contrast, 1.0) if laplacian.size else 0.0,
        frozen=previous is not None and same_picture(sketch_of(image), sketch_of(previous)),
    )


def exposure(
    pictures: Sequence[PictureStatistics], levels: Sequence[float], followers: int
) -> Exposure | None:
    """Shares of badly exposed images.

    Args:
        pictures: of the sampled images.
        levels: mean brightness of each.
        followers: how many of them had the image before them to compare with.
    """
    if not pictures:
        return None
    sharpness = np.array([picture.sharpness for picture in pictures])
    return Exposure(
        too_dark=_share([picture.problem is Reason.DARK for picture in pictures]),
        overexposed=_share([picture.problem is Reason.BRIGHT for picture in pictures]),
        without_contrast=_share([picture.problem is Reason.FLAT for picture in pictures]),
        frozen=sum(picture.frozen for picture in pictures) / max(followers, 1),
        blurred=float((sharpness < 0.4 * np.median(sharpness)).mean()),
        median_level=float(np.median(levels)),
    )


def truth_statistics(labelled_frames: int, counts: NDArray[np.int64]) -> TruthStatistics:
    """From the sum of `truth_counts` over the frames that were read; counts[4] is their number."""
    floor, obstacle, above, floor_above, read = (int(count) for count in counts)
    total = max(floor + obstacle + above, 1)
    return TruthStatistics(
        labelled_frames, read, floor / total, obstacle / total, above / total, floor_above / max(floor, 1)
    )


def truth_counts(frame: Frame) -> NDArray[np.int64]:
    """(5,) pixels labelled floor, obstacle and above, floor pixels a degree over the horizon, and 1."""
    from horizon_dl.geometry.rays import camera_rays

    counts = np.zeros(5, np.int64)
    if frame.truth is None:
        return counts
    floor = frame.truth == Truth.FLOOR
    counts[:3] = [floor.sum(), (frame.truth == Truth.OBSTACLE).sum(), (frame.truth == Truth.ABOVE).sum()]
    if frame.up_cam is not None:
        angle = elevation(camera_rays(frame.camera).directions, frame.up_cam)
        counts[3] = (floor & (angle > np.deg2rad(1.0))).sum()
    counts[4] = 1
    return counts


def _share(flags: Sequence[bool]) -> float:
    return float(np.mean(flags))

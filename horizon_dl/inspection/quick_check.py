"""The quick part of the data check, for verbs that are about to learn: seconds, on long recordings, too."""

from collections.abc import Sequence

import numpy as np

from horizon_dl.data.evenly import evenly
from horizon_dl.data.source import Recording
from horizon_dl.errors import FrameError, InputError
from horizon_dl.evidence.sketch import luma
from horizon_dl.inspection.check_result import DataCheck
from horizon_dl.inspection.findings import QUICK_RULES, with_findings
from horizon_dl.inspection.image_quality import PictureStatistics, exposure, picture_statistics
from horizon_dl.inspection.timing_and_attitude import attitudes, label_statistics, timing

MOST_IMAGES, MOST_HEADERS = 12, 300


def quick_check(recording: Recording, band_rad: float) -> DataCheck:
    """Counts, times and attitudes of all frames, the horizon in some hundred, the exposure of a dozen.

    Args:
        recording: of any format.
        band_rad: half width of the ignored band around the horizon, rad.

    Raises:
        InputError: the recording has no frames or no known camera.
    """
    if not recording.headers:
        raise InputError(recording.name, "has no frames", "check the folder and its image list")
    pictures, levels, unreadable = _look(recording, evenly(range(recording.length), MOST_IMAGES))
    usable = [index for index, header in enumerate(recording.headers) if header.up_cam is not None]
    some = recording.select(evenly(usable, MOST_HEADERS))
    check = DataCheck(
        name=recording.name,
        format=recording.format,
        frames=recording.length,
        sampled=len(pictures) + len(unreadable),
        unreadable=len(unreadable),
        unreadable_examples=tuple(unreadable),
        band_deg=float(np.rad2deg(band_rad)),
        notes=tuple(recording.notes),
        timing=timing(recording.headers),
        attitudes=attitudes(recording.headers),
        labels=label_statistics(some, band_rad) if usable else None,
        exposure=exposure(pictures, levels, 0),
        motion=None,
        height_m=None,
        truth=None,
    )
    return with_findings(check, QUICK_RULES)


def _look(
    recording: Recording, indices: Sequence[int]
) -> tuple[list[PictureStatistics], list[float], list[tuple[str, str]]]:
    """Statistics and brightness of some pictures, and those that cannot be read, with the reason."""
    pictures, levels, unreadable = [], [], []
    for index in indices:
        try:
            image = recording.read(index, with_truth=False).image
        except FrameError as error:
            unreadable.append((recording.headers[index].name, str(error)))
            continue
        small = image[:: max(1, image.shape[0] // 240), :: max(1, image.shape[1] // 320)]
        pictures.append(picture_statistics(small, None))
        levels.append(float(luma(small).mean()))
    return pictures, levels, unreadable

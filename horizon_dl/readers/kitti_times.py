"""Times of KITTI's images, and the attitudes of its oxts at those times."""

from datetime import UTC, datetime
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from horizon_dl.data.regular_file import read_regular
from horizon_dl.data.tables.parsing import decimals, read_lines, whole_number
from horizon_dl.errors import InputError
from horizon_dl.geometry.attitude import (
    MAX_GAP_S,
    interpolate,
    quaternion_from_rpy,
    rotation_from_quaternion,
    rpy_from_rotation,
)

Floats = NDArray[np.float64]

FRAME_PERIOD_S = 0.1
MOST_FRAMES = 10_000_000
MOST_OXTS = 4096
"""Bytes of a frame's file: 30 numbers."""

EDGE_S = 0.05
"""How far outside of the oxts' times an image takes the nearest one: half a period of the camera."""


def attitudes_at_images(drive: Path, images: list[Path]) -> tuple[list[float], list[Floats | None]]:
    """Times of the images (s since the first stamp), and their attitudes (body FRD to a world with z down).

    Paired by time stamps where both sides have them. Without, numbers serve, but only where the oxts were
    reduced to the images, one each.

    Raises:
        InputError: time stamps are missing, and the numbers do not belong together.
    """
    oxts = sorted((drive / "oxts" / "data").glob("*.txt"))
    image_times, oxts_times = _clocks(drive, images, file_numbers(images), file_numbers(oxts))
    pairs = ((time_s, _attitude(path)) for time_s, path in zip(oxts_times.tolist(), oxts, strict=True))
    samples = sorted(((time_s, q) for time_s, q in pairs if q is not None), key=lambda pair: pair[0])
    start_s = image_times[0] if len(image_times) else 0.0
    times = (image_times - start_s).tolist()
    if not samples:
        return times, [None] * len(times)
    sample_times = np.array([time_s for time_s, _ in samples])
    quaternions = np.array([q for _, q in samples])
    return times, [_attitude_at(sample_times, quaternions, time_s) for time_s in image_times.tolist()]


def _clocks(drive: Path, images: list[Path], numbers: list[int], oxts: list[int]) -> tuple[Floats, Floats]:
    """Times (s) of the images and of the oxts, on one clock."""
    data = images[0].parent if images else drive
    images_s = _stamps(data, max(numbers, default=0))
    oxts_s = _stamps(drive / "oxts" / "data", max(oxts, default=0))
    if images_s is None or oxts_s is None:
        _check_reduced(drive, numbers, oxts, images_s, oxts_s)
        # One clock for both: that of a list which tells the times of all numbers, else a steady one.
        longest = max([*numbers, *oxts], default=0)
        lists = (one for one in (images_s, oxts_s) if one is not None and len(one) > longest)
        steady = FRAME_PERIOD_S * np.arange(longest + 1, dtype=np.float64)
        clock: Floats = next(lists, np.asarray(steady, np.float64))
        return clock[numbers], clock[oxts]
    return images_s[numbers], oxts_s[oxts]


def file_numbers(paths: list[Path]) -> list[int]:
    """The numbers that name the files, or their places where they have other names."""
    numbers = [whole_number(path.stem) for path in paths]
    known = [number for number in numbers if number is not None and number < MOST_FRAMES]
    return known if len(known) == len(paths) else [*range(len(paths))]


def parse_time(path: Path, line: str) -> float:
    """Seconds (epoch 1970, UTC) of a line like `2011-09-26 14:19:35.668269525`."""
    try:
        whole, _, fraction = line.strip().partition(".")
        moment = datetime.strptime(whole, "%Y-%m-%d %H:%M:%S").replace(tzinfo=UTC)
        return moment.timestamp() + decimals(fraction)
    except ValueError:
        raise InputError(path, f"holds no time in {line.strip()[:40]!r}", "copy the file again") from None


def _stamps(data: Path, last: int) -> Floats | None:
    """Times of a sensor's files by their numbers; None where not all of them have one."""
    places = (data.parent / "timestamps.txt", data / "timestamps.txt")
    path = next((place for place in places if place.is_file()), None)
    if path is None:
        return None
    stamps = np.array([parse_time(path, line) for line in read_lines(path)])
    return stamps if len(stamps) > last else None


def _check_reduced(
    drive: Path, numbers: list[int], oxts_numbers: list[int], images_s: Floats | None, oxts_s: Floats | None
) -> None:
    """InputError where the oxts are more than one for each image, so that numbers tell nothing."""
    if oxts_s is not None and len(oxts_s) > 1:
        reduced = float(np.median(np.diff(oxts_s))) > FRAME_PERIOD_S / 2
    else:
        count = max(numbers, default=-1) + 1 if images_s is None else len(images_s)
        reduced = max(oxts_numbers, default=-1) < count
    if not reduced:
        missing = f"{'image' if images_s is None else 'oxts'} time stamps"
        problem = f"has {len(oxts_numbers)} oxts for {len(numbers)} images, and no {missing} to pair them by"
        raise InputError(drive, problem, "copy the timestamps.txt of the images and of oxts")


def _attitude_at(times_s: Floats, quaternions: Floats, time_s: float) -> Floats | None:
    near = min(max(time_s, float(times_s[0])), float(times_s[-1]))
    return interpolate(times_s, quaternions, near, MAX_GAP_S) if abs(near - time_s) <= EDGE_S else None


def _attitude(path: Path) -> Floats | None:
    """Body FRD to a world with z down, from one oxts file; None where it holds none.

    oxts angles are about x forward, y left, z up (dataformat.txt: roll > 0 left side up, pitch > 0 front
    down, yaw > 0 counter-clockwise from east). Turning both the body and the world by half a turn about x
    gives FRD and a world whose z points down; there roll keeps its sign, pitch and yaw change theirs.
    """
    try:
        roll, pitch, yaw = (float(cell) for cell in read_regular(path, MOST_OXTS).split()[3:6])
    except (OSError, ValueError, InputError):
        return None
    return quaternion_from_rpy(roll, -pitch, -yaw) if np.isfinite([roll, pitch, yaw]).all() else None


def oxts_angles(attitude: Floats) -> tuple[float, float, float]:
    """Roll, pitch, yaw (rad) as the oxts have them, of an attitude as `attitudes_at_images` gives it."""
    roll, pitch, yaw = rpy_from_rotation(rotation_from_quaternion(attitude))
    return roll, -pitch, -yaw

"""The camera of an image topic: its CameraInfo, read as a camera_info file is."""

from pathlib import Path
from typing import Any

import numpy as np

from horizon_dl.calibration import ros
from horizon_dl.calibration.calibration import Calibration
from horizon_dl.calibration.candidate import Wanted
from horizon_dl.calibration.fields import Fields
from horizon_dl.errors import InputError
from horizon_dl.logs.bags.messages import decoder, frame_name
from horizon_dl.logs.bags.storage import Bag, Topic

KIND = "sensor_msgs/msg/CameraInfo"
TRANSPORTS = ("compressed", "raw", "theora", "ffmpeg", "zstd")


def info_topic(bag: Bag, image: str, frame: str, named: tuple[str, ...]) -> Topic | None:
    """The CameraInfo that belongs to an image topic: named, beside it, or the only one of its frame."""
    infos = [topic for topic in bag.topics.values() if topic.kind == KIND and topic.count]
    for topic in infos:
        if topic.name in named:
            return topic
    beside = f"{base_topic(image).rpartition('/')[0]}/camera_info"
    for topic in infos:
        if topic.name == beside:
            return topic
    of_frame = [topic for topic in infos if frame_name(_first(bag, topic).header.frame_id) == frame]
    return of_frame[0] if len(of_frame) == 1 else None


def base_topic(name: str) -> str:
    """An image topic without the way of transport.

    Example:
        >>> base_topic("/camera/image_raw/compressed")
        '/camera/image_raw'
    """
    head, _, tail = name.rpartition("/")
    return head if tail in TRANSPORTS and head else name


def is_rectified(image: str) -> bool:
    """Whether the topic's pictures have been undistorted, by the names that image_proc gives."""
    return base_topic(image).rpartition("/")[2].startswith("image_rect")


def camera_of(bag: Bag, topic: Topic, image: str, size: tuple[int, int]) -> Calibration | None:
    """The camera; None where the message says that it is not calibrated.

    Args:
        bag: that holds it.
        topic: of the CameraInfo.
        image: name of the topic of the pictures.
        size: width and height of the pictures, pixels.

    Raises:
        InputError: a lens that is not known, or of other pictures.
    """
    info = _first(bag, topic)
    matrix, coefficients = _field(info, "k"), _field(info, "d")
    if not matrix[0] > 0:
        return None
    if is_rectified(image):
        projection = _field(info, "p").reshape(3, 4)
        if projection[0, 0] > 0:
            matrix, coefficients = projection[:, :3].ravel(), np.zeros(0)
    matrix, width, height = _of_region(info, matrix)
    where = f"{bag.path}: {topic.name}"
    if (width, height) != size:
        raise InputError(
            where,
            f"is of pictures of {width}x{height} pixels, {image} has {size[0]}x{size[1]}",
            "give --camera FILE of these pictures",
        )
    content = {
        **{"width": width, "height": height, "K": matrix.tolist()},
        **{"distortion_model": str(info.distortion_model), "D": coefficients.tolist()},
    }
    (only,) = ros.candidates(Fields(Path(where), content), Wanted(size))
    return Calibration(only.build().camera)


def _first(bag: Bag, topic: Topic) -> Any:
    for _, payload in bag.messages(topic):
        return decoder(bag, topic)(payload)
    raise InputError(bag.path, f"holds no message of {topic.name}", "it was cut off; copy it again")


def _field(info: Any, name: str) -> Any:
    """ROS 1 writes K, D, P; ROS 2 k, d, p."""
    value = getattr(info, name) if hasattr(info, name) else getattr(info, name.upper())
    return np.asarray(value, np.float64)


def _of_region(info: Any, matrix: Any) -> tuple[Any, int, int]:
    """K, width and height of the pictures as sent: a region of the sensor, and pixels put together."""
    roi, across, down = info.roi, max(int(info.binning_x), 1), max(int(info.binning_y), 1)
    width, height = (
        (int(roi.width) or int(info.width)) // across,
        (int(roi.height) or int(info.height)) // down,
    )
    sent = np.array(matrix).reshape(3, 3)
    for row, offset, factor in ((0, roi.x_offset, across), (1, roi.y_offset, down)):
        sent[row, row] /= factor
        sent[row, 2] = (sent[row, 2] - offset + 0.5) / factor - 0.5
    return sent.ravel(), width, height

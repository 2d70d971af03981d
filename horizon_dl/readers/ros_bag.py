"""ROS bags: ROS 1 `.bag`, ROS 2 `.db3` and `.mcap`, or the folder of one.

Pictures, camera and attitude are found by content; `--topic NAME` chooses where several fit. How the camera
sits in the robot is told by tf, else by `--camera FILE` with mount_rpy_deg.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from horizon_dl.calibration.calibration import Calibration, read_calibration
from horizon_dl.data.attitude_log import AttitudeLog
from horizon_dl.data.convention import Convention, Reading, reading_with
from horizon_dl.data.doubt import Doubt
from horizon_dl.data.frame import FrameHeader
from horizon_dl.data.given import NOTHING_GIVEN, Given
from horizon_dl.data.source import Recording
from horizon_dl.errors import FrameError, InputError
from horizon_dl.geometry.attitude import MountRpy
from horizon_dl.logs.bags.camera_info import camera_of, info_topic
from horizon_dl.logs.bags.choose import Series, check_named, image_topic, up_series
from horizon_dl.logs.bags.files import bag_files
from horizon_dl.logs.bags.loader import BagLoader, Place, placed
from horizon_dl.logs.bags.messages import NANOSECOND, decoder, stamp_of
from horizon_dl.logs.bags.mounted import Mounted, mounted
from horizon_dl.logs.bags.pixels import bits_of, is_wide, picture
from horizon_dl.logs.bags.storage import Bag, Topic
from horizon_dl.logs.bags.transforms import read_transforms
from horizon_dl.logs.camera_and_log import camera_and_log, check_camera
from horizon_dl.logs.log_recording import headers_by_log

Floats = NDArray[np.float64]

NAME = "ros_bag"
LOOKED_AT = 16
"""Pictures that tell how many bits a camera uses."""
MOST_BROKEN = 100
"""First pictures that may be broken before the topic is given up."""
CLOCKS_APART_S = 0.3
"""Pictures arrive later than attitudes, but seldom by so much. Not picked on data."""
NEEDS = "a ROS bag (.bag, .db3, .mcap, or the folder of one) with pictures"


def recognises(path: Path) -> bool:
    """Whether the path is a bag, or a folder with one."""
    return bool(bag_files(path))


def read(path: Path, given: Given = NOTHING_GIVEN) -> Recording:
    """Opens a bag; its pictures are decoded when asked for, fastest in their order.

    Raises:
        InputError: it is damaged, or something is missing or there several times; it says what to give.
    """
    bag = Bag(path)
    check_named(bag, given.topics)
    images = image_topic(bag, given.topics)
    places, stamps, frame, headless = _places(bag, images)
    shape, bits = _looked_at(bag, images)
    arrivals = np.array([place.arrival_ns * NANOSECOND for place in places])
    times = arrivals if headless else stamps
    calibration, notes = _calibration(bag, images, frame, shape, given)
    check_camera(path, calibration, given)
    turns = 0 if calibration is None else calibration.rotate_quarter_turns_ccw
    order = np.argsort(times, kind="stable")
    headers = [FrameHeader(f"{n:06d}", float(times[k])) for n, k in enumerate(order)]
    mount: MountRpy | None = None
    moved: AttitudeLog | None = None
    reading: Reading | None = None
    if calibration is not None and given.attitude is not None:
        names = [one.name for one in headers]
        calibration, log = camera_and_log(calibration, given.attitude, given)
        mount = calibration.known_mount
        headers, moved, said = headers_by_log(path, names, times[order].tolist(), calibration, log, given)
        reading = reading_with(Convention(), calibration.mount_rpy_rad)
        notes = (*notes, *said)
    elif calibration is not None:
        mount = calibration.mount_rpy_rad
        found = _attitude(bag, frame, calibration, stamps, arrivals, headless, given)
        if found is not None:
            if found.by_arrival and not headless:
                times = arrivals
            order = np.argsort(times, kind="stable")
            headers = [
                found.header(f"{n:06d}", float(times[k]), given.time_offset_s) for n, k in enumerate(order)
            ]
            mount, notes, reading = found.mount_rpy_rad, (*notes, *found.notes), found.reading
    if given.needs_attitude and all(header.up_cam is None for header in headers):
        raise InputError(
            path,
            "holds no attitude that changes at the times of its pictures",
            "record an Imu, Odometry or tf, or give --attitude FILE, constant:ROLL,PITCH or from-images",
        )
    load = BagLoader(path, images.name, tuple(places[k] for k in order), bits, turns)
    camera = None if calibration is None else calibration.camera
    said_first = (f"pictures of {images.name}", *notes)
    return Recording(
        path.stem, NAME, camera, headers, load, mount, said_first, reading=reading, attitudes=moved
    )


def _places(bag: Bag, topic: Topic) -> tuple[list[Place], Floats, str, bool]:
    """Places and header stamps (s) of all pictures, their frame, and whether the headers have no stamps."""
    places, stamps, frame = [], [], ""
    for place, payload in placed(bag.messages(topic)):
        stamp_s, frame = stamp_of(payload, topic.ros2)
        places.append(place)
        stamps.append(stamp_s)
    if not places:
        raise InputError(bag.path, f"holds no picture in {topic.name}", "copy it again")
    return places, np.array(stamps), frame, not all(stamp > 0 for stamp in stamps)


def _looked_at(bag: Bag, topic: Topic) -> tuple[tuple[int, ...], int]:
    """Shape of the pictures, and the bits that they use, by some of them over the whole bag.

    Raises:
        FrameError: none of them can be read.
    """
    decode, step = decoder(bag, topic), max(1, topic.count // LOOKED_AT)
    shape: tuple[int, ...] | None = None
    bits, problem = 8, FrameError(topic.name, "holds no picture", "copy the bag again")
    for number, (_, payload) in enumerate(bag.messages(topic)):
        if number % step and shape is not None:
            continue
        try:
            message = decode(payload)
            shape = shape or picture(message, f"{bag.path}: {topic.name}").shape
            bits = max(bits, bits_of(message))
            if not is_wide(message):
                break
        except InputError as error:
            problem = FrameError(*error.args)
        if number > MOST_BROKEN and shape is None:
            break
    if shape is None:
        raise problem
    return shape, bits


def _calibration(
    bag: Bag, images: Topic, frame: str, shape: tuple[int, ...], given: Given
) -> tuple[Calibration | None, tuple[str, ...]]:
    if given.camera is not None:
        return read_calibration(given.camera, imu_axes=given.imu_axes), ()
    info = info_topic(bag, images.name, frame, given.topics)
    calibration = None if info is None else camera_of(bag, info, images.name, (shape[1], shape[0]))
    if calibration is not None and info is not None:
        return calibration, (f"camera of {info.name}",)
    if given.needs_attitude:
        problem = f"{info.name} is not calibrated" if info else f"no CameraInfo goes with {images.name}"
        raise InputError(bag.path, problem, "give --camera FILE")
    return None, ()


def _attitude(
    bag: Bag,
    frame: str,
    calibration: Calibration,
    stamps: Floats,
    arrivals: Floats,
    headless: bool,
    given: Given,
) -> Mounted | None:
    """What tells the attitude, by the headers' stamps, else by arrival where the two clocks never meet."""
    tree = read_transforms(bag)
    series = up_series(bag, tree, frame, given.topics, headless)
    if series is None:
        return None
    times = arrivals if headless else stamps
    first, last = (stamp + given.time_offset_s for stamp in series.span_s)
    by_arrival = headless or last < times.min() or first > times.max()
    said = _clock_notes(by_arrival, headless, float(np.median(arrivals - stamps)), series)
    if by_arrival and not headless:
        series = up_series(bag, tree, frame, given.topics, arrivals=True)
    if series is None:
        return None
    try:
        found = mounted(bag.path, tree, series, frame, calibration, has_mount=given.camera is not None)
    except InputError:
        if given.needs_attitude:
            raise
        return None
    return replace(found, by_arrival=by_arrival, notes=(*found.notes, *said))


def _clock_notes(by_arrival: bool, headless: bool, late_s: float, series: Series) -> tuple[str, ...]:
    """What is to be known of the two clocks; `late_s` is from the pictures' stamps to their arrival."""
    if by_arrival:
        why = "the pictures have no stamps" if headless else "their stamps never meet"
        return (f"pictures and attitudes are paired by their times of arrival: {why}",)
    if series.late_s is None or abs(late_s - series.late_s) < CLOCKS_APART_S:
        return ()
    return (
        Doubt(
            f"by the times of arrival the pictures' stamps are {series.late_s - late_s:+.1f} s against those "
            f"of {series.topic}: one clock may be wrong, --time-offset=auto finds it from the pictures"
        ),
    )

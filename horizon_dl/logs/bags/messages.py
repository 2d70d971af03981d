"""Messages of a topic: decoded as the bag defines them, else as ROS does; their header's stamp and frame."""

import struct
from collections.abc import Callable
from typing import Any

from horizon_dl.logs.bags.storage import Bag, Topic, reading

NANOSECOND = 1e-9

PX4_ATTITUDE = """uint64 timestamp
uint64 timestamp_sample
float32[4] q
float32[4] delta_q_reset
uint8 quat_reset_counter
"""
WITHOUT_DEFINITION = {"px4_msgs/msg/VehicleAttitude": PX4_ATTITUDE}
"""What bags of before 2023 hold without its definition, though it is no part of ROS."""


def decoder(bag: Bag, topic: Topic) -> Callable[[bytes], Any]:
    """Makes messages of a topic's payloads; InputError for damaged ones.

    The definitions of other topics are not looked at: one that is broken is of no concern here.
    """
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore

    text = topic.definition or WITHOUT_DEFINITION.get(topic.kind)
    with reading(bag.path):
        store = get_typestore(Stores.LATEST if topic.ros2 else Stores.ROS1_NOETIC)
        if text:
            store = get_typestore(Stores.EMPTY)
            store.register(get_types_from_msg(text, topic.kind))
    decode = store.deserialize_cdr if topic.ros2 else store.deserialize_ros1

    def message(payload: bytes) -> Any:
        with reading(bag.path):
            return decode(payload, topic.kind)

    return message


def stamp_of(payload: bytes, ros2: bool) -> tuple[float, str]:
    """Time (s) and frame of the header with which a payload begins.

    An image is not decoded for it.

    Example:
        >>> stamp_of(struct.pack("<IIII3s", 0, 5, 500_000_000, 3, b"cam"), ros2=False)
        (5.5, 'cam')
    """
    order = "<" if not ros2 or payload[1] & 1 else ">"
    seconds, nanoseconds, length = struct.unpack_from(f"{order}iII", payload, 4)
    text = payload[16 : 16 + length].split(b"\0")[0].decode("utf-8", "replace")
    return seconds + nanoseconds * NANOSECOND, frame_name(text)


def header_of(message: Any) -> tuple[float, str]:
    """Time (s) and frame of a decoded message's header; PX4's have microseconds and no frame."""
    header = getattr(message, "header", None)
    if header is None:
        return float(message.timestamp) * 1e-6, ""
    return header.stamp.sec + header.stamp.nanosec * NANOSECOND, frame_name(header.frame_id)


def frame_name(name: str) -> str:
    """A frame's name without the slash that ROS before 2013 put in front."""
    return name.strip().lstrip("/")

"""The messages of ROS 2 that are published without ROS, as their definitions have them.

The names of the types are those that ROS 2 gives its messages in DDS.
"""

# mypy: disable-error-code="call-arg, misc"
# cyclonedds says nothing of its types that mypy understands.

from dataclasses import dataclass, field

import cyclonedds.idl as idl
from cyclonedds.idl import annotations, types


@dataclass
@annotations.final
@annotations.cdrv0
class Time(idl.IdlStruct, typename="builtin_interfaces.msg.dds_.Time_"):
    """Seconds since 1970, and the rest."""

    sec: types.int32
    nanosec: types.uint32


@dataclass
@annotations.final
@annotations.cdrv0
class Header(idl.IdlStruct, typename="std_msgs.msg.dds_.Header_"):
    """When, and in which frame."""

    stamp: Time
    frame_id: str


@dataclass
@annotations.final
@annotations.cdrv0
class LaserScan(idl.IdlStruct, typename="sensor_msgs.msg.dds_.LaserScan_"):
    """Distances over angles, counter-clockwise from above, rad and m."""

    header: Header
    angle_min: types.float32
    angle_max: types.float32
    angle_increment: types.float32
    time_increment: types.float32
    scan_time: types.float32
    range_min: types.float32
    range_max: types.float32
    ranges: types.sequence[types.float32]
    intensities: types.sequence[types.float32] = field(default_factory=list)


@dataclass
@annotations.final
@annotations.cdrv0
class Image(idl.IdlStruct, typename="sensor_msgs.msg.dds_.Image_"):
    """A picture, row by row."""

    header: Header
    height: types.uint32
    width: types.uint32
    encoding: str
    is_bigendian: types.uint8
    step: types.uint32
    data: types.sequence[types.uint8]

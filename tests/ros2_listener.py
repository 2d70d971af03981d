"""A process that knows the messages of ROS 2 and nothing of this package: prints what it hears as JSON.

python ros2_listener.py DOMAIN SECONDS
"""

import json
import sys
import time
from dataclasses import dataclass

from cyclonedds.core import Policy, Qos
from cyclonedds.domain import Domain, DomainParticipant
from cyclonedds.idl import IdlStruct, types
from cyclonedds.idl.annotations import cdrv0, final
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration

LOOPBACK = """<CycloneDDS><Domain><General><Interfaces><NetworkInterface address="127.0.0.1"/></Interfaces>
<AllowMulticast>false</AllowMulticast></General><Discovery><ParticipantIndex>auto</ParticipantIndex>
<Peers><Peer address="127.0.0.1"/></Peers></Discovery></Domain></CycloneDDS>"""

NUMBERS = ("angle_min", "angle_max", "angle_increment", "range_min", "range_max", "ranges")


@dataclass
@final
@cdrv0
class Stamp(IdlStruct, typename="builtin_interfaces.msg.dds_.Time_"):
    sec: types.int32
    nanosec: types.uint32


@dataclass
@final
@cdrv0
class StampAndFrame(IdlStruct, typename="std_msgs.msg.dds_.Header_"):
    stamp: Stamp
    frame_id: str


@dataclass
@final
@cdrv0
class Scan(IdlStruct, typename="sensor_msgs.msg.dds_.LaserScan_"):
    header: StampAndFrame
    angle_min: types.float32
    angle_max: types.float32
    angle_increment: types.float32
    time_increment: types.float32
    scan_time: types.float32
    range_min: types.float32
    range_max: types.float32
    ranges: types.sequence[types.float32]
    intensities: types.sequence[types.float32]


def main() -> None:
    domain, seconds = int(sys.argv[1]), float(sys.argv[2])
    kept = Domain(domain, LOOPBACK)
    participant = DomainParticipant(domain)
    quality = Qos(Policy.Reliability.Reliable(duration(seconds=1)), Policy.History.KeepLast(10))
    reader = DataReader(participant, Topic(participant, "rt/horizon_dl/distances", Scan), qos=quality)
    print("listening", flush=True)
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        for scan in reader.take(10):
            fields = {name: value for name, value in vars(scan).items() if name in NUMBERS}
            stamp = scan.header.stamp
            fields |= {"frame": scan.header.frame_id, "age_s": time.time() - stamp.sec - stamp.nanosec / 1e9}
            print(json.dumps(fields))
            return
        time.sleep(0.02)
    del kept


main()

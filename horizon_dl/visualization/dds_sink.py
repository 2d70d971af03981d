"""A sink that publishes what ROS 2 nodes read, distances and the obstacle map, by DDS and without ROS."""

import time
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from horizon_dl.data.frame import Frame
from horizon_dl.errors import InputError
from horizon_dl.ranging.sectors import FreeDistances, Outcome
from horizon_dl.runtime.prediction import Prediction
from horizon_dl.runtime.ranged import Ranged

SCAN, MAP = "horizon_dl/distances", "horizon_dl/obstacles"
"""Names as ROS 2 shows them; in DDS they begin with `rt/`."""
FRAME_ID = "base_link"
LOOPBACK = "127.0.0.1"
MOST_DOMAIN = 232
CONFIG = """<CycloneDDS><Domain><General>
<Interfaces><NetworkInterface address="{host}"/></Interfaces><AllowMulticast>{multicast}</AllowMulticast>
</General><Discovery><ParticipantIndex>auto</ParticipantIndex>{peers}</Discovery></Domain></CycloneDDS>"""


@dataclass(frozen=True)
class Network:
    """A domain of DDS on one of this machine's networks."""

    domain: int
    host: str = LOOPBACK

    @classmethod
    def parse(cls, text: str) -> "Network":
        """`0`, only for this machine, or `192.168.1.7:0`, for the network of that address.

        Raises:
            InputError: it is neither.
        """
        host, _, domain = text.rpartition(":")
        if not (domain.isdigit() and int(domain) <= MOST_DOMAIN):
            problem = f"is no domain from 0 to {MOST_DOMAIN}"
            raise InputError(f"--dds {text}", problem, "give DOMAIN, or ADDRESS:DOMAIN for a network")
        return cls(int(domain), host or LOOPBACK)

    def config(self) -> str:
        """For Cyclone DDS."""
        alone = self.host == LOOPBACK
        peers = f'<Peers><Peer address="{LOOPBACK}"/></Peers>' if alone else ""
        return CONFIG.format(host=self.host, multicast="false" if alone else "true", peers=peers)


class Dds:
    """Publishes a `sensor_msgs/LaserScan` and a `sensor_msgs/Image` a frame.

    Args:
        network: where.
        min_m, max_m: nearer obstacles are said to be at the one, farther ones are none.

    Raises:
        ModuleNotFoundError: cyclonedds, of the extra `dds`, is not installed.
        InputError: the network cannot be used.
    """

    def __init__(self, network: Network, min_m: float, max_m: float) -> None:
        from cyclonedds.core import DDSException, Policy, Qos
        from cyclonedds.domain import Domain, DomainParticipant
        from cyclonedds.pub import DataWriter
        from cyclonedds.topic import Topic
        from cyclonedds.util import duration

        from horizon_dl.visualization import ros2_types

        self._types: Any = ros2_types
        self._limits_m = (min_m, max_m)
        # A flight's frames carry the monotonic clock; others wait for the clock on the wall.
        self._epoch_s = time.time() - time.monotonic()
        quality = Qos(Policy.Reliability.Reliable(duration(milliseconds=1)), Policy.History.KeepLast(1))
        try:
            self._domain: Any = Domain(network.domain, network.config())
            self._participant: Any = DomainParticipant(network.domain)
        except DDSException as error:
            problem = f"cannot be opened ({error.msg})"
            raise InputError(
                f"--dds {network.host}:{network.domain}", problem, "give another address"
            ) from None
        self._scans, self._maps = (
            DataWriter(self._participant, Topic(self._participant, f"rt/{name}", kind), qos=quality)
            for name, kind in ((SCAN, ros2_types.LaserScan), (MAP, ros2_types.Image))
        )

    def log(self, frame: Frame, prediction: Prediction, ranges: Ranged | None) -> None:
        """See `Sink`."""
        seconds, rest = divmod(round((frame.time_s + self._epoch_s) * 1e9), 10**9)
        stamp = self._types.Time(seconds, rest)
        if ranges is not None:
            self._scans.write(scan_message(self._types, stamp, ranges.found, *self._limits_m))
        believed = ranges is not None and bool((ranges.found.outcome != Outcome.UNKNOWN).any())
        self._maps.write(map_message(self._types, stamp, prediction.obstacles, believed))

    def close(self) -> None:
        """See `Sink`."""
        self._scans = self._maps = self._participant = self._domain = None  # closed with their last reference


def scan_message(types: Any, stamp: Any, found: FreeDistances, min_m: float, max_m: float) -> Any:
    """Sectors as a scan: +inf where it is free as far as `max_m`, NaN where nothing is known (REP 117).

    Bearings run clockwise, a scan's angles the other way round. An obstacle without metres is not known; one
    that covers the nearest visible ground is said to be at `min_m`, so that every receiver stops before it.
    """
    metres = np.full(len(found.outcome), np.nan, np.float32)
    # Free, but not as far as a scan would claim: the camera looks down, or the height is not known.
    far_enough = np.nan_to_num(found.distance_m, nan=0.0) > max_m
    metres[(found.outcome == Outcome.FREE) & far_enough] = np.inf
    met = (found.outcome == Outcome.OBSTACLE) & np.isfinite(found.distance_m)
    metres[met] = np.where(found.contact_seen[met], np.maximum(found.distance_m[met], min_m), min_m)
    metres[metres > max_m] = np.inf
    angles = -found.bearing_rad[::-1].astype(np.float64)
    return types.LaserScan(
        header=types.Header(stamp, FRAME_ID),
        angle_min=float(angles[0]),
        angle_max=float(angles[-1]),
        angle_increment=float((angles[-1] - angles[0]) / max(len(angles) - 1, 1)),
        time_increment=0.0,
        scan_time=0.0,
        range_min=min_m,
        range_max=max_m,
        ranges=metres[::-1].tolist(),
    )


def map_message(types: Any, stamp: Any, obstacles: NDArray[np.bool_], believed: bool) -> Any:
    """The paper's obstacle map as a `mono8` picture: 255 on obstacles, 0 elsewhere.

    Of a frame of which no sector is known it says nothing, 128 everywhere: an empty map would read as free.
    """
    height, width = obstacles.shape
    data = (
        np.where(obstacles, np.uint8(255), np.uint8(0))
        if believed
        else np.full_like(obstacles, 128, np.uint8)
    )
    return types.Image(types.Header(stamp, "camera"), height, width, "mono8", 0, width, data.tobytes())

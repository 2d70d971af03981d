"""What ROS 2 nodes are told, without ROS: held against its definitions, heard by another process."""

import json
import math
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from rosbags.typesys import Stores, get_typestore

from horizon_dl.errors import InputError
from horizon_dl.ranging.sectors import FreeDistances, Outcome
from horizon_dl.visualization import ros2_types
from horizon_dl.visualization.dds_sink import Dds, Network, map_message, scan_message

STORE = get_typestore(Stores.ROS2_HUMBLE)
STAMP = ros2_types.Time(1_700_000_000, 250_000_000)
NAN = float("nan")
DOMAIN = 87


def sectors() -> FreeDistances:
    """From the left: unknown, free, free but not far, met at 2 m, too near, met without metres, far."""
    unknown, free, met = Outcome.UNKNOWN, Outcome.FREE, Outcome.OBSTACLE
    outcome = np.array([unknown, free, free, met, met, met, met], np.uint8)
    metres = np.array([NAN, np.inf, 4.0, 2.0, 0.8, NAN, 30.0], np.float32)
    seen = np.array([False, True, True, True, False, True, True])
    bearing = np.radians(np.arange(-15, 20, 5)).astype(np.float32)
    zeros = np.zeros(7, np.float32)
    return FreeDistances(bearing, outcome, metres, zeros, zeros, zeros, seen, zeros)


WANTED = [NAN, math.inf, NAN, 2.0, 0.2, NAN, math.inf]
"""Of those sectors, at least 0.2 m and at most 10 m, from left to right."""


def test_a_scan_says_no_more_than_is_known_and_turns_the_other_way():
    scan = scan_message(ros2_types, STAMP, sectors(), 0.2, 10.0)
    np.testing.assert_allclose(scan.ranges, WANTED[::-1])  # angles rise to the left
    angles = scan.angle_min + scan.angle_increment * np.arange(7)
    np.testing.assert_allclose(np.degrees(angles), np.arange(-15, 20, 5), atol=1e-4)
    assert angles[scan.ranges.index(2.0)] == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("bearing", [-10.0, 15.0])
def test_what_is_on_the_right_has_a_negative_angle(bearing):
    found = sectors()
    outcome = np.where(np.isclose(np.degrees(found.bearing_rad), bearing, atol=0.1), Outcome.OBSTACLE, 0)
    ones = np.ones(7, np.float32)
    only = FreeDistances(found.bearing_rad, outcome.astype(np.uint8), ones, ones, ones, ones, ones > 0, ones)
    scan = scan_message(ros2_types, STAMP, only, 0.2, 10.0)
    index = int(np.flatnonzero(np.isfinite(scan.ranges))[0])
    assert math.degrees(scan.angle_min + index * scan.angle_increment) == pytest.approx(-bearing, abs=1e-3)


def test_the_bytes_are_those_of_ros_messages():
    """rosbags has ROS 2's own definitions."""
    scan = scan_message(ros2_types, STAMP, sectors(), 0.2, 10.0)
    read = STORE.deserialize_cdr(scan.serialize(), "sensor_msgs/msg/LaserScan")
    assert (read.header.stamp.sec, read.header.stamp.nanosec) == (1_700_000_000, 250_000_000)
    assert read.header.frame_id == "base_link"
    np.testing.assert_allclose(read.ranges, WANTED[::-1])
    assert (read.range_min, read.range_max) == (np.float32(0.2), 10.0)
    assert len(read.intensities) == 0
    obstacles = np.array([[True, False, False], [False, False, True]])
    image = STORE.deserialize_cdr(
        map_message(ros2_types, STAMP, obstacles, True).serialize(), "sensor_msgs/msg/Image"
    )
    assert (image.height, image.width, image.step, image.encoding) == (2, 3, 3, "mono8")
    np.testing.assert_array_equal(image.data.reshape(2, 3), [[255, 0, 0], [0, 0, 255]])


@pytest.mark.parametrize("obstacles", [np.zeros((2, 3), bool), np.eye(2, 3, dtype=bool)])
def test_the_map_of_a_frame_that_is_not_believed_says_nothing(obstacles):
    image = map_message(ros2_types, STAMP, obstacles, False)
    assert bytes(image.data) == bytes([128] * 6)


def test_another_process_hears_a_flight(tmp_path):
    """A replay of the embedded flight, and a listener that knows the messages alone."""
    from horizon_dl.cli import main
    from horizon_dl.simulation.embedded import embedded_set

    model = Path(__file__).parent.parent / "exports" / "reference" / "model.onnx"
    listener = Path(__file__).with_name("ros2_listener.py")
    command = [sys.executable, "-I", str(listener), str(DOMAIN), "20"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as heard:
        assert heard.stdout is not None
        assert heard.stdout.readline() == "listening\n"
        words = ["fly", model, "--source", embedded_set(), "--mavlink", "udpout:127.0.0.1:14599"]
        assert main([*map(str, words), "--duration", "6", "--dds", str(DOMAIN), "-q"]) == 0
        said, _ = heard.communicate(timeout=30)
    scan = json.loads(said)
    assert scan["frame"] == "base_link"
    assert (scan["range_min"], scan["range_max"]) == (pytest.approx(0.2), 10.0)
    assert len(scan["ranges"]) > 20
    assert 0 < scan["age_s"] < 10  # its stamp is the time of the picture, on the clock on the wall
    assert scan["angle_min"] < 0 < scan["angle_max"]


@pytest.mark.parametrize("text", ["", "x", "233", "-1", "127.0.0.1", "127.0.0.1:x"])
def test_no_domain_is_one_line(text):
    with pytest.raises(InputError, match="is no domain"):
        Network.parse(text)


def test_only_this_machine_hears_unless_an_address_is_given():
    assert Network.parse("7") == Network(7, "127.0.0.1")
    assert "<AllowMulticast>false" in Network.parse("7").config()
    assert Network.parse("10.0.0.5:7") == Network(7, "10.0.0.5")
    with pytest.raises(InputError, match="cannot be opened"):
        Dds(Network.parse("203.0.113.5:88"), 0.2, 10.0)

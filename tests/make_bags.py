"""Bags of every kind, written by rosbags' own writers."""

import io
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

from horizon_dl.geometry.attitude import quaternion_from_rpy

KINDS = (
    "bag",
    "bag_bz2",
    "bag_lz4",
    "db3",
    "db3_message",
    "db3_file",
    "mcap",
    "mcap_storage",
    "mcap_message",
)
START_S = 1_700_000_000
SIZE = (32, 24)

Rows = list[tuple[str, float, Any]]


class Maker:
    """Makes messages of one generation of ROS and writes them."""

    def __init__(self, ros2: bool = True, extra: dict[str, str] | None = None) -> None:
        from rosbags.typesys import Stores, get_types_from_msg, get_typestore

        self.ros2 = ros2
        self.store = get_typestore(Stores.ROS2_HUMBLE if ros2 else Stores.ROS1_NOETIC)
        transforms = {"tf2_msgs/msg/TFMessage": "geometry_msgs/msg/TransformStamped[] transforms"}
        for name, text in {**({} if ros2 else transforms), **(extra or {})}.items():
            self.store.register(get_types_from_msg(text, name))

    def new(self, kind: str, **values: Any) -> Any:
        return self.store.types[kind](**values)

    def header(self, time_s: float, frame: str) -> Any:
        nanoseconds = round((START_S + time_s) * 1e9) if time_s >= 0 else 0
        stamp = self.new("builtin_interfaces/msg/Time", sec=nanoseconds // 10**9, nanosec=nanoseconds % 10**9)
        seq = {} if self.ros2 else {"seq": 0}
        return self.new("std_msgs/msg/Header", stamp=stamp, frame_id=frame, **seq)

    def image(self, time_s: float, pixels: np.ndarray, encoding: str = "rgb8", frame: str = "cam") -> Any:
        rows = np.ascontiguousarray(pixels).reshape(len(pixels), -1)
        data = rows.view(np.uint8)
        return self.new(
            "sensor_msgs/msg/Image",
            header=self.header(time_s, frame),
            height=pixels.shape[0],
            width=pixels.shape[1],
            encoding=encoding,
            is_bigendian=0,
            step=data.shape[1],
            data=data.ravel(),
        )

    def compressed(self, time_s: float, pixels: np.ndarray, frame: str = "cam") -> Any:
        file = io.BytesIO()
        Image.fromarray(pixels).save(file, "PNG")
        data = np.frombuffer(file.getvalue(), np.uint8)
        return self.new(
            "sensor_msgs/msg/CompressedImage", header=self.header(time_s, frame), format="png", data=data
        )

    def info(
        self, frame: str = "cam", size: tuple[int, int] = SIZE, focal: float = 30.0, **values: Any
    ) -> Any:
        names = "dkrp" if self.ros2 else "DKRP"
        width, height = size
        matrix = [focal, 0, (width - 1) / 2, 0, focal, (height - 1) / 2, 0, 0, 1]
        projection = [focal, 0, (width - 1) / 2, 0, 0, focal, (height - 1) / 2, 0, 0, 0, 1, 0]
        numbers = [np.zeros(5), np.array(matrix, float), np.eye(3).ravel(), np.array(projection, float)]
        roi = self.new(
            "sensor_msgs/msg/RegionOfInterest", x_offset=0, y_offset=0, height=0, width=0, do_rectify=False
        )
        fields: dict[str, Any] = {
            "height": height,
            "width": width,
            "binning_x": 0,
            "binning_y": 0,
            "roi": roi,
        }
        fields["distortion_model"] = "plumb_bob"
        fields |= dict(zip(names, numbers, strict=True)) | {"header": self.header(0, frame)} | values
        return self.new("sensor_msgs/msg/CameraInfo", **fields)

    def xyz(self, values: Sequence[float]) -> Any:
        return self.new("geometry_msgs/msg/Vector3", **dict(zip("xyz", map(float, values), strict=True)))

    def quaternion(self, wxyz: Sequence[float]) -> Any:
        return self.new("geometry_msgs/msg/Quaternion", **dict(zip("wxyz", map(float, wxyz), strict=True)))

    def imu(
        self,
        time_s: float,
        wxyz: Sequence[float] | None,
        force: Sequence[float] = (0, 0, 9.81),
        rate: Sequence[float] = (0, 0, 0),
        frame: str = "imu",
    ) -> Any:
        covariance = np.zeros(9)
        covariance[0] = -1 if wxyz is None else 0
        return self.new(
            "sensor_msgs/msg/Imu",
            header=self.header(time_s, frame),
            orientation=self.quaternion(wxyz or (1, 0, 0, 0)),
            orientation_covariance=covariance,
            angular_velocity=self.xyz(rate),
            angular_velocity_covariance=np.zeros(9),
            linear_acceleration=self.xyz(force),
            linear_acceleration_covariance=np.zeros(9),
        )

    def transform(self, time_s: float, parent: str, child: str, wxyz: Sequence[float]) -> Any:
        one = self.new(
            "geometry_msgs/msg/TransformStamped",
            header=self.header(time_s, parent),
            child_frame_id=child,
            transform=self.new(
                "geometry_msgs/msg/Transform",
                translation=self.xyz((0, 0, 0)),
                rotation=self.quaternion(wxyz),
            ),
        )
        return self.new("tf2_msgs/msg/TFMessage", transforms=[one])

    def write(self, path: Path, rows: Rows, kind: str = "mcap") -> Path:
        """Writes messages (topic, time of arrival in s after the start, message); gives the bag's path."""
        return write_ros2(self, path, rows, kind) if self.ros2 else write_ros1(self, path, rows, kind)


def write_ros1(maker: Maker, path: Path, rows: Rows, kind: str) -> Path:
    from rosbags.rosbag1 import Writer

    path = path.with_suffix(".bag")
    writer = Writer(path)
    for name in ("bz2", "lz4"):
        if kind.endswith(name):
            writer.set_compression(getattr(Writer.CompressionFormat, name.upper()))
    with writer:
        topics = {}
        for topic, time_s, message in sorted(rows, key=lambda row: row[1]):
            name = message.__msgtype__
            if topic not in topics:
                topics[topic] = writer.add_connection(topic, name, typestore=maker.store)
            data = maker.store.serialize_ros1(message, name)
            writer.write(topics[topic], round((START_S + time_s) * 1e9), data)
    return path


def write_ros2(maker: Maker, path: Path, rows: Rows, kind: str) -> Path:
    from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer

    storage, _, mode = kind.partition("_")
    plugin = StoragePlugin.MCAP if storage == "mcap" else StoragePlugin.SQLITE3
    writer = Writer(path, version=9, storage_plugin=plugin)
    if mode:
        writer.set_compression(CompressionMode[mode.upper()], CompressionFormat.ZSTD)
    with writer:
        topics = {}
        for topic, time_s, message in sorted(rows, key=lambda row: row[1]):
            name = message.__msgtype__
            if topic not in topics:
                topics[topic] = writer.add_connection(topic, name, typestore=maker.store)
            data = maker.store.serialize_cdr(message, name)
            writer.write(topics[topic], round((START_S + time_s) * 1e9), data)
    return path


OPTICAL_IN_FLU = (0.5, -0.5, 0.5, -0.5)
"""Turn of an optical frame whose z points along the body's x (REP 103), (w, x, y, z)."""


def flight(maker: Maker, count: int = 8) -> tuple[Rows, np.ndarray, np.ndarray]:
    """A camera that looks along the body's x and an IMU in the body; also pictures and up directions (FRD).

    The body pitches nose down and rolls; ROS has FLU in ENU: roll stays, pitch and yaw change their sign.
    """
    rng = np.random.default_rng(0)
    pictures = rng.integers(0, 255, (count, SIZE[1], SIZE[0], 3)).astype(np.uint8)
    rows: Rows = [("/tf_static", 0.0, maker.transform(0.0, "imu", "cam", OPTICAL_IN_FLU))]
    ups = []
    for index, pixels in enumerate(pictures):
        roll, pitch = attitude_at(index * 0.1)
        ups.append([-np.sin(roll) * np.cos(pitch), -np.cos(roll) * np.cos(pitch), np.sin(pitch)])
        rows.append(("/camera/image_raw", index * 0.1 + 0.03, maker.image(index * 0.1, pixels)))
        rows.append(("/camera/camera_info", index * 0.1 + 0.03, maker.info()))
    for time_s in np.arange(0.0, count * 0.1, 0.01):
        roll, pitch = attitude_at(time_s)
        q = quaternion_from_rpy(roll, -pitch, 0.4)
        force = np.array([np.sin(pitch), np.sin(roll) * np.cos(pitch), np.cos(roll) * np.cos(pitch)]) * 9.81
        rows.append(("/imu", time_s, maker.imu(time_s, q.tolist(), force)))
    return rows, pictures, np.array(ups)


def attitude_at(time_s: float) -> tuple[float, float]:
    """Roll and pitch (rad, aerospace) of the made flight."""
    return 0.3 * np.sin(4 * time_s), -0.2 + 0.1 * np.cos(3 * time_s)

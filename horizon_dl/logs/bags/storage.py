"""The files of a bag: ROS 1 `.bag`, ROS 2 `.db3` and `.mcap`; their topics and raw messages."""

import tempfile
import weakref
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from horizon_dl.errors import InputError
from horizon_dl.logs.bags.files import MAGIC, PACKED, bag_files, begin, kind_of
from horizon_dl.logs.bags.unpack import unpack_file, unpacked

WAYS_OUT = {
    ".bag": "copy it again, or run `rosbag reindex` on it",
    ".db3": "copy it again, or run `sqlite3 OLD.db3 .recover`",
    ".mcap": "copy it again, or run `mcap recover OLD.mcap -o NEW.mcap`",
}


@dataclass(frozen=True)
class Topic:
    """A topic of a bag.

    Attributes:
        name: as `/camera/image_raw`.
        kind: of its messages, as `sensor_msgs/msg/Image`.
        count: of its messages.
        definition: of the messages, the text that the bag holds; None where it holds none that can be used.
        ros2: the messages are CDR; else as in ROS 1.
    """

    name: str
    kind: str
    count: int
    definition: str | None
    ros2: bool


@contextmanager
def reading(path: Path) -> Iterator[None]:
    """Turns whatever damaged bytes cause in the library into an InputError."""
    try:
        yield
    except (InputError, ImportError):
        raise
    except Exception as error:  # the library lets through what the damage causes: struct, assert, sqlite, ...
        said = " ".join(str(error).replace(str(path), path.name).split())[:120].rstrip(".")
        why = said or type(error).__name__
        hint = WAYS_OUT.get(kind_of(path), "copy it again")
        raise InputError(path, f"cannot be read as a ROS bag ({why})", hint) from None


class Bag:
    """A bag, open; its files stay open as long as it lives."""

    def __init__(self, path: Path) -> None:
        """Opens all files.

        Raises:
            InputError: the library is not installed, or a file is damaged.
        """
        self.path = path
        self._readers: list[tuple[Path, Any]] = []
        for file in bag_files(path):
            with reading(file):
                self._readers.append((file, self._opened(file)))
        if not self._readers:
            raise InputError(path, "holds no bag", "give a .bag, .db3 or .mcap file, or their folder")
        self._readers.sort(key=lambda pair: pair[1].start_time)
        self.topics = self._find_topics()

    def messages(self, topic: Topic, start_ns: int | None = None) -> Iterator[tuple[int, bytes]]:
        """Times of arrival (ns) and payloads of a topic, from a time on, in the order of arrival."""
        for file, reader in self._readers:
            mine = [one for one in reader.connections if one.topic == topic.name]
            if mine and (start_ns is None or reader.end_time > start_ns):
                with reading(file):
                    for _, time_ns, payload in reader.messages(mine, start=start_ns):
                        yield time_ns, unpacked(payload)

    def _opened(self, file: Path) -> Any:
        try:
            from rosbags import rosbag1, rosbag2
        except ImportError:
            raise InputError(file, "is a ROS bag", "install horizon-dl[logs] to read it") from None
        kind = kind_of(file)
        if file.suffix.lower() == PACKED:
            file = self._unpacked_file(file)
        is_first = kind == ".bag" or begin(file).startswith(MAGIC[0])
        reader: Any = rosbag1.Reader(file) if is_first else rosbag2.Reader(file)
        reader.open()
        weakref.finalize(self, reader.close)
        return reader

    def _unpacked_file(self, file: Path) -> Path:
        """A copy without the compression, which lives as long as the bag is open."""
        folder = tempfile.TemporaryDirectory(prefix="horizon-dl-bag-")
        weakref.finalize(self, folder.cleanup)
        return unpack_file(file, Path(folder.name))

    def _find_topics(self) -> dict[str, Topic]:
        topics: dict[str, Topic] = {}
        for _, reader in self._readers:
            ros2 = type(reader).__module__.startswith("rosbags.rosbag2")
            for one in reader.connections:
                before = topics.get(one.topic)
                count = one.msgcount + (before.count if before else 0)
                text = one.msgdef.data if one.msgdef.format.name == "MSG" else None
                topics[one.topic] = Topic(one.topic, full_name(one.msgtype), count, text, ros2)
        return topics


def full_name(kind: str) -> str:
    """The kind of a message as ROS 2 names it, however old the recorder.

    Example:
        >>> full_name("sensor_msgs/Image")
        'sensor_msgs/msg/Image'
    """
    package, _, name = kind.partition("/")
    return kind if "/" in name or not name else f"{package}/msg/{name}"

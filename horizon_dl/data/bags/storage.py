"""The files of a bag: ROS 1 `.bag`, ROS 2 `.db3` and `.mcap`; their topics and raw messages."""

import tempfile
import weakref
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from horizon_dl.data.bags.unpack import unpack_file, unpacked
from horizon_dl.errors import InputError

SUFFIXES = (".bag", ".db3", ".mcap")
PACKED = ".zstd"
MAGIC = (b"#ROSBAG V", b"\x89MCAP0\r\n")
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


def bag_files(path: Path) -> list[Path]:
    """The files of a bag: itself, or those of a folder; none where it is no bag.

    metadata.yaml is not asked: it names splits that were not copied, and is missing after a power cut.
    """
    if path.is_dir():
        found = [one for one in path.iterdir() if one.is_file() and _kind_of(one) in SUFFIXES]
        return sorted(found, key=lambda one: (len(one.name), one.name))  # _10 follows _9
    if not path.is_file():
        return []
    return [path] if _kind_of(path) in SUFFIXES or _starts_as_bag(path) else []


def _kind_of(path: Path) -> str:
    suffixes = [one.lower() for one in path.suffixes if one.lower() != PACKED]
    return suffixes[-1] if suffixes else ""


def _starts_as_bag(path: Path) -> bool:
    try:
        with path.open("rb") as file:
            return file.read(9).startswith(MAGIC)
    except OSError:
        return False


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
        way_out = WAYS_OUT.get(_kind_of(path), "copy it again")
        raise InputError(path, f"cannot be read as a ROS bag ({why})", way_out) from None


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
        kind = _kind_of(file)
        if file.suffix.lower() == PACKED:
            file = self._unpacked_file(file)
        is_first = kind == ".bag" or file.open("rb").read(9) == MAGIC[0]
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

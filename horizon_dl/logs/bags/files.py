"""Which files make a bag."""

from pathlib import Path

SUFFIXES = (".bag", ".db3", ".mcap")
PACKED = ".zstd"
MAGIC = (b"#ROSBAG V", b"\x89MCAP0\r\n")


def bag_files(path: Path) -> list[Path]:
    """The files of a bag: itself, or those of a folder; none where it is no bag.

    metadata.yaml is not asked: it names splits that were not copied, and is missing after a power cut.
    """
    if path.is_dir():
        found = [one for one in path.iterdir() if one.is_file() and kind_of(one) in SUFFIXES]
        return sorted(found, key=lambda one: (len(one.name), one.name))  # _10 follows _9
    if not path.is_file():
        return []
    return [path] if kind_of(path) in SUFFIXES or _starts_as_bag(path) else []


def kind_of(path: Path) -> str:
    """The suffix that says what a file is, without that of its compression."""
    suffixes = [one.lower() for one in path.suffixes if one.lower() != PACKED]
    return suffixes[-1] if suffixes else ""


def _starts_as_bag(path: Path) -> bool:
    try:
        return begin(path).startswith(MAGIC)
    except OSError:
        return False


def begin(path: Path) -> bytes:
    """The first nine bytes."""
    with path.open("rb") as file:
        return file.read(9)

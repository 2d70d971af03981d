"""What `predict` takes: a data set, or plain pictures."""

from pathlib import Path

from horizon_dl.data.frame import Recording
from horizon_dl.data.readers.image_files import picture_paths
from horizon_dl.data.readers.registry import open_recording

Source = Recording | list[Path]


def open_source(source: Path, format: str | None) -> Source:
    """A data set, or else plain pictures.

    Raises:
        InputError: neither; what a data set needs is in the message.
    """
    pictures = picture_paths(source)
    if pictures and format is None and not (source / "camera.yaml").exists():
        return pictures
    return open_recording(source, format)


def frame_count(source: Source) -> int:
    """Number of frames or pictures."""
    return len(source.entries) if isinstance(source, Recording) else len(source)

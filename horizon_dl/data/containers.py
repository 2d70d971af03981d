"""Opens films and what else a container holds, by PyAV."""

from pathlib import Path
from typing import Any

from horizon_dl.errors import InputError


def opened(path: Path) -> Any:
    """An open container; close it, or use it in `with`.

    Raises:
        InputError: PyAV is missing, the file is no container, or it has no film.
    """
    try:
        import av
    except ImportError:
        raise InputError(path, "is a film", "install horizon-dl[logs] to read it") from None
    # What is damaged is told in our words. Never a level: a decoding thread that logs would wait for Python's
    # lock, which is held while a container is closed.
    av.logging.set_level(None)
    try:
        container = av.open(str(path))
    except (av.error.FFmpegError, OSError, ValueError):
        raise InputError(path, "is no film that can be read", "convert it to MP4 with H.264") from None
    if not container.streams.video:
        container.close()
        raise InputError(path, "holds no film", "give a file with a video track")
    return container

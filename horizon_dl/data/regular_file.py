"""Files from strangers: regular ones, of bounded size. A pipe or a device would wait or run on for ever."""

import errno
import stat
from pathlib import Path

from horizon_dl.errors import InputError

MOST_TEXT = 256 * 2**20
"""Bytes of a text file: a log of several hours at 200 Hz."""


def check_there(path: Path) -> None:
    """Something is there that can be read: a file, a folder, a camera's device.

    Raises:
        InputError: if not, or its name cannot be one.
    """
    try:
        mode = path.stat().st_mode
    except (OSError, ValueError) as error:
        missing = getattr(error, "errno", None) in (errno.ENOENT, errno.ENOTDIR)
        reason = "does not exist" if missing else f"cannot be read ({_reason(error)})"
        raise InputError(path, reason, "check the path") from None
    if not (stat.S_ISREG(mode) or stat.S_ISDIR(mode) or stat.S_ISCHR(mode)):
        raise InputError(path, "is neither a file nor a folder", "copy what it gives into a file")


def check_regular(path: Path, most_bytes: int | None = None) -> None:
    """The path is a file with an end.

    Raises:
        FileNotFoundError: there is nothing.
        InputError: it is a folder, pipe, socket or device, is too large, or cannot be looked at.
    """
    try:
        found = path.stat()
    except FileNotFoundError:
        raise
    except (OSError, ValueError) as error:
        raise InputError(path, f"cannot be read ({_reason(error)})", "check the path") from None
    if not stat.S_ISREG(found.st_mode):
        kind = "folder" if stat.S_ISDIR(found.st_mode) else "pipe or device"
        raise InputError(path, f"is a {kind}, no file", "give a file")
    if most_bytes is not None and found.st_size > most_bytes:
        raise InputError(path, f"is larger than {most_bytes // 1024} KB", "check that it is the right file")


def files_in(folder: Path) -> list[Path]:
    """Files of a folder by name; none where it may not be listed."""
    try:
        return sorted(path for path in folder.iterdir() if path.is_file())
    except OSError:
        return []


def read_regular(path: Path, most_bytes: int = MOST_TEXT) -> str:
    """The text of a file in UTF-8.

    Raises:
        FileNotFoundError: there is nothing.
        InputError: see `check_regular`, or it is no text.
    """
    check_regular(path, most_bytes)
    try:
        with path.open("rb") as file:
            return file.read(most_bytes + 1).decode("utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(path, f"cannot be read as text ({_reason(error)})", "check the file") from None


def _reason(error: Exception) -> str:
    return getattr(error, "strerror", None) or type(error).__name__

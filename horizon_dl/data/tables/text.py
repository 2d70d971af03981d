"""Text files in the encodings that spreadsheets and loggers write."""

import codecs
from pathlib import Path

from horizon_dl.data.regular_file import MOST_TEXT, check_regular
from horizon_dl.errors import InputError

MARKS = (
    (codecs.BOM_UTF32_LE, "utf-32-le"),  # begins as UTF-16's does
    (codecs.BOM_UTF32_BE, "utf-32-be"),
    (codecs.BOM_UTF8, "utf-8"),
    (codecs.BOM_UTF16_LE, "utf-16-le"),
    (codecs.BOM_UTF16_BE, "utf-16-be"),
)

PACKED = (".gz", ".zip", ".7z", ".xz", ".bz2", ".zst", ".tar", ".tgz", ".rar")
UNPACK = "unpack it, and give what is in it"
NO_TEXT = {
    **dict.fromkeys(PACKED, UNPACK),
    ".tlog": "it is MAVLink telemetry: make a table of its ATTITUDE messages (time_s, roll_rad, pitch_rad)",
    ".xlsx": "it is a spreadsheet: save it as CSV",
}
"""What to do with files that are no text, by their suffix."""


def read_lines(path: Path, head_bytes: int | None = None) -> list[str]:
    """Lines of a text file without blank ones.

    Args:
        path: of the file.
        head_bytes: read no more than the whole lines in so many bytes.

    Raises:
        InputError: missing or not text.
    """
    try:
        check_regular(path, MOST_TEXT)
        with path.open("rb") as file:
            data = file.read(-1 if head_bytes is None else head_bytes)
        text = decoded(_whole_lines(data) if len(data) == head_bytes else data)
    except FileNotFoundError:
        raise InputError(path, "is missing", "restore the file") from None
    except (OSError, UnicodeDecodeError) as error:
        way_out = NO_TEXT.get(path.suffix.lower(), "check the file")
        raise InputError(path, f"cannot be read as text ({type(error).__name__})", way_out) from None
    return [line for line in text.splitlines() if line.strip()]


def _whole_lines(data: bytes) -> bytes:
    """The start of a file up to its last whole line; all of it where it has none."""
    ends = (b"\n\0", b"\0\n") if b"\0" in data else (b"\n",)  # UTF-16 has two bytes a letter
    end = max(data.rfind(one) + len(one) if one in data else 0 for one in ends)
    return data[:end] or data


def decoded(data: bytes) -> str:
    r"""The text in a file: UTF-8, UTF-16 with or without its mark, else Windows' Western one.

    Raises:
        UnicodeDecodeError: it is no text.

    Example:
        >>> decoded("a;b".encode("utf-16")), decoded(b"roll [\xb0]")
        ('a;b', 'roll [°]')
    """
    for mark, encoding in MARKS:
        if data.startswith(mark):
            return data[len(mark) :].decode(encoding)
    # Text of Latin letters in UTF-16 has a zero in every second byte, and no other text has any.
    if len(data) >= 4 and data[1] == 0 == data[3]:
        return data.decode("utf-16-le")
    if len(data) >= 4 and data[0] == 0 == data[2]:
        return data.decode("utf-16-be")
    data = data.rstrip(b"\0")  # what a file system leaves at the end when the power goes
    if b"\0" in data:
        raise UnicodeDecodeError("utf-8", data, data.index(b"\0"), data.index(b"\0") + 1, "a zero byte")
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError:
        return data.decode("cp1252")

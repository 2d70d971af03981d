"""`frames.jsonl`: one line a frame, cut back to the last checkpoint on resuming, patient with a full disk."""

import json
import os
from collections import deque
from pathlib import Path
from typing import Any

MOST_WAITING = 100_000
"""Lines held while the disk is full; older ones are lost then."""


class FrameLog:
    """Appends lines of JSON.

    Attributes:
        offset: bytes that are in the file; what came later is cut off when the log is opened.
    """

    def __init__(self, path: Path, offset: int = 0) -> None:
        """Open, or create.

        Raises:
            OSError: the file cannot be written.
        """
        self.offset = min(offset, path.stat().st_size if path.exists() else 0)
        self._file = path.open("r+b" if path.exists() else "w+b", buffering=0)
        self._file.truncate(self.offset)
        self._waiting: deque[bytes] = deque(maxlen=MOST_WAITING)

    def add(self, line: dict[str, Any]) -> None:
        """Take a line, and write it if the disk allows; if not, it waits for the next one."""
        self._waiting.append(json.dumps(line, allow_nan=False).encode() + b"\n")
        try:
            self._write()
        except OSError:
            return

    def save(self) -> None:
        """Force all lines to the disk.

        Raises:
            OSError: they cannot be written.
        """
        self._write()
        os.fsync(self._file.fileno())

    def close(self) -> None:
        """Close the file."""
        self._file.close()

    def _write(self) -> None:
        """Whole lines only: what a full disk cut off is written again in its place."""
        content = b"".join(self._waiting)
        self._file.seek(self.offset)
        if self._file.write(content) != len(content):
            self._file.truncate(self.offset)
            raise OSError("the disk is full")
        self._waiting.clear()
        self.offset += len(content)

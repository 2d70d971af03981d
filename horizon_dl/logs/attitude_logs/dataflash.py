"""ArduPilot's log (.bin, or .log as text): ATT, and CAM or TRIG at the shutter, by pymavlink."""

import contextlib
import math
import os
import sys
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from horizon_dl.data.attitude_log import AttitudeLog, Floats, log_of_angles
from horizon_dl.data.tables.parsing import by_time
from horizon_dl.errors import InputError

NAME = "dataflash"
NEEDS = "ArduPilot's log, .bin or .log"
MARKER = b"\xa3\x95"
WANTED = ["ATT", "AHR2", "CAM", "TRIG", "RFND", "GPS"]
ANGLES = (("Roll", "Pitch", "Yaw"), ("R", "P", "Y"))
"""Names of angles in degrees; CAM and TRIG have the shorter ones since 4.3."""
GPS_EPOCH_S = 315964800
MOST_TOLD = 100_000
LEAP_SECONDS = 18
"""Between GPS time and UTC, since 2017."""


def recognises(path: Path, head: bytes) -> bool:
    """Whether the file holds DataFlash messages, in bytes or as text."""
    binary = head.startswith(MARKER) or (path.suffix.lower() == ".bin" and MARKER in head)
    return binary or head.startswith(b"FMT,") or (path.suffix.lower() == ".log" and b"\nFMT," in head)


def read(path: Path) -> AttitudeLog:
    """The autopilot's attitude in degrees, seconds since boot; a CAM row is the attitude at a picture.

    Raises:
        InputError: pymavlink is missing, nothing can be read, or no attitude is logged.
    """
    try:
        from pymavlink import DFReader
    except ImportError:
        raise InputError(path, "is an ArduPilot log", "install horizon-dl[logs] to read it") from None
    with _overheard() as told:
        rows = _rows(path, DFReader)
    times_s, angles = _attitudes(rows["ATT"])
    notes: tuple[str, ...] = ()
    if not len(times_s):
        times_s, angles = _attitudes(rows["AHR2"])
        notes = ("The log has no ATT: the attitude is that of AHR2, the autopilot's second estimate.",)
    if not len(times_s):
        raise InputError(path, "holds no ATT message", "set LOG_BITMASK to log the attitude")
    log = log_of_angles(times_s, angles, _heights(rows["RFND"], times_s))
    taken_s, taken = _attitudes(rows["CAM"])
    if not len(taken_s):
        taken_s, taken = _attitudes(rows["TRIG"])
    shutter = log_of_angles(taken_s, taken) if len(taken_s) else None
    if any("bad header" in line for line in told):
        notes = (*notes, "The log is damaged in places; the rest is used.")
    return AttitudeLog(
        log.times_s,
        log.quaternions,
        log.heights_m,
        shutter=shutter,
        unix_start_s=_unix_start(rows["GPS"], float(log.times_s[0])),
        notes=notes,
    )


@contextlib.contextmanager
def _overheard() -> Iterator[list[str]]:
    """What the library says of bad headers, in place of the error stream; its C part writes past Python."""
    told: list[str] = []
    sys.stderr.flush()
    kept = os.dup(2)
    with tempfile.TemporaryFile("w+", errors="replace") as file:
        os.dup2(file.fileno(), 2)
        try:
            with contextlib.redirect_stderr(file), contextlib.redirect_stdout(file):
                yield told
        finally:
            os.dup2(kept, 2)
            os.close(kept)
            file.seek(0)
            told.append(file.read(MOST_TOLD))


def _rows(path: Path, library: Any) -> dict[str, list[Any]]:
    """Messages by kind, as far as the log can be read."""
    rows: dict[str, list[Any]] = {kind: [] for kind in WANTED}
    with path.open("rb") as file:
        binary = MARKER in file.read(4096)
    try:
        log = (_advancing(library.DFReader_binary) if binary else library.DFReader_text)(str(path))
    except Exception as error:  # the library raises what parsing a damaged file happens to raise
        problem = f"is no ArduPilot log that can be read ({type(error).__name__})"
        raise InputError(path, problem, "copy it from the card again") from None
    try:
        while (message := log.recv_match(type=WANTED)) is not None:
            rows[message.get_type()].append(message)
    except Exception:  # a log that is cut off: what was read counts
        pass
    finally:
        with contextlib.suppress(Exception):
            log.close()
    return rows


def _advancing(reader: Any) -> Any:
    """The library's reader, ended where a damaged length lets it stand still: it would read on for ever."""

    class Advancing(reader):  # type: ignore[misc]
        def _parse_next(self) -> Any:
            before = self.offset
            message = super()._parse_next()
            if message is not None and self.offset <= before:
                raise ValueError("a message without length")
            return message

    return Advancing


def _attitudes(messages: list[Any]) -> tuple[Floats, Floats]:
    """Times (N,) s and angles (N, 3) rad."""
    found = [_numbers(messages, ("TimeUS", *names)) for names in ANGLES]
    values = max(found, key=len)
    return values[:, 0] * 1e-6, np.deg2rad(values[:, 1:])


def _heights(messages: list[Any], times_s: Floats) -> Floats | None:
    """A rangefinder's distance where it is good (status 4) and looks down (orientation 25), m."""
    values = _numbers(messages, ("TimeUS", "Dist", "Stat", "Orient"))
    good = values[(values[:, 2] == 4) & (values[:, 3] == 25)]
    if not len(good):
        return None
    measured_s, distances_m = by_time(good[:, 0] * 1e-6, good[:, 1:2])
    return np.interp(times_s, measured_s, distances_m[:, 0], left=np.nan, right=np.nan)


def _unix_start(messages: list[Any], start_s: float) -> float | None:
    for time_us, week, milliseconds in _numbers(messages, ("TimeUS", "GWk", "GMS")).tolist():
        if week > 0:
            unix = GPS_EPOCH_S + week * 604800 + milliseconds * 1e-3 - LEAP_SECONDS
            return float(unix - time_us * 1e-6 + start_s)
    return None


def _numbers(messages: list[Any], names: Sequence[str]) -> Floats:
    """Fields (N, k) of the messages that have all of them as finite numbers; the rest is damage."""
    rows = []
    for message in messages:
        try:
            row = [float(getattr(message, name)) for name in names]
        except (AttributeError, LookupError, TypeError, ValueError, OverflowError):
            continue
        if all(map(math.isfinite, row)):
            rows.append(row)
    return np.array(rows, np.float64).reshape(-1, len(names))

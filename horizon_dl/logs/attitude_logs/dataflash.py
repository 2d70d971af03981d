"""ArduPilot's log (.bin, or .log as text): ATT, and CAM or TRIG at the shutter, by pymavlink."""

import contextlib
import os
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from horizon_dl.data.attitude_log import AttitudeLog, Floats, log_of_angles
from horizon_dl.errors import InputError

NAME = "dataflash"
NEEDS = "ArduPilot's log, .bin or .log"
MARKER = b"\xa3\x95"
WANTED = ["ATT", "CAM", "TRIG", "RFND", "GPS"]
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
    if not rows["ATT"]:
        raise InputError(path, "holds no ATT message", "set LOG_BITMASK to log the attitude")
    times_s, angles = _attitudes(rows["ATT"])
    log = log_of_angles(times_s, angles, _heights(rows["RFND"], times_s))
    cameras = rows["CAM"] or rows["TRIG"]
    shutter = log_of_angles(*_attitudes(cameras)) if cameras and hasattr(cameras[0], "Roll") else None
    notes = (
        ("The log is damaged in places; the rest is used.",) if any("bad header" in t for t in told) else ()
    )
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
        log = (library.DFReader_binary if binary else library.DFReader_text)(str(path))
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


def _attitudes(messages: list[Any]) -> tuple[Floats, Floats]:
    """Times (N,) s and angles (N, 3) rad."""
    rows = [(m.TimeUS * 1e-6, m.Roll, m.Pitch, m.Yaw) for m in messages]
    values = np.array(rows, np.float64)
    return values[:, 0], np.deg2rad(values[:, 1:])


def _heights(messages: list[Any], times_s: Floats) -> Floats | None:
    """A rangefinder's distance where it is good (status 4) and looks down (orientation 25), m."""
    good = [
        (m.TimeUS * 1e-6, m.Dist)
        for m in messages
        if getattr(m, "Stat", 0) == 4 and getattr(m, "Orient", 0) == 25 and hasattr(m, "Dist")
    ]
    if not good:
        return None
    measured = np.array(good, np.float64)
    return np.interp(times_s, measured[:, 0], measured[:, 1], left=np.nan, right=np.nan)


def _unix_start(messages: list[Any], start_s: float) -> float | None:
    for m in messages:
        if getattr(m, "GWk", 0) > 0:
            unix = GPS_EPOCH_S + m.GWk * 604800 + m.GMS * 1e-3 - LEAP_SECONDS
            return float(unix - m.TimeUS * 1e-6 + start_s)
    return None

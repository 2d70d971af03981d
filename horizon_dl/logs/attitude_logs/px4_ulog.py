"""PX4's log (.ulg): `vehicle_attitude`, by pyulog."""

import contextlib
import io
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from horizon_dl.data.attitude_log import AttitudeLog, Floats
from horizon_dl.errors import InputError

NAME = "ulog"
NEEDS = "PX4's log, .ulg"
MAGIC = b"ULog\x01\x12\x35"
MESSAGES = ["vehicle_attitude", "vehicle_local_position", "vehicle_gps_position"]
READ_TWICE, LEAST_READ = 4, 10_000
"""So many times its size may be read of a log, and bytes more."""
QUATERNION = [f"q[{index}]" for index in range(4)]


class _Bounded(io.BufferedReader):
    """A file that ends a reader which goes back in it again and again: pyulog circles at some damages."""

    def __init__(self, raw: io.FileIO) -> None:
        super().__init__(raw)
        self._left = READ_TWICE * raw.seek(0, io.SEEK_END) + LEAST_READ
        raw.seek(0)

    def read(self, size: int | None = -1, /) -> bytes:
        content = super().read(size)
        self._left -= max(1, len(content))
        if self._left < 0:
            raise EOFError("it is damaged")
        return content


def recognises(path: Path, head: bytes) -> bool:
    """Whether the file begins as every ULog does."""
    return head.startswith(MAGIC)


def read(path: Path) -> AttitudeLog:
    """Attitude w x y z, FRD to NED; times are microseconds since boot, or of 1970 from a simulator.

    Raises:
        InputError: pyulog is missing, the file is damaged at its start, or it logs no attitude.
    """
    try:
        from pyulog import ULog
    except ImportError:
        raise InputError(path, "is a PX4 log", "install horizon-dl[logs] to read it") from None
    try:
        # It prints what it finds damaged.
        with contextlib.redirect_stdout(io.StringIO()), _Bounded(io.FileIO(path)) as file:
            log = ULog(file, MESSAGES)
    except Exception as error:  # pyulog lets through whatever a damaged file makes of its parsing
        raise InputError(
            path, f"is no ULog that can be read ({error})", "copy it from the card again"
        ) from None
    attitude = _topic(log, "vehicle_attitude")
    if attitude is None or not set(QUATERNION) <= set(attitude):
        raise InputError(path, "logs no vehicle_attitude", "set SDLOG_PROFILE to log the attitude")
    quaternions = np.stack([attitude[name] for name in QUATERNION], axis=-1).astype(np.float64)
    times_s = attitude["timestamp"].astype(np.float64) * 1e-6
    length = np.linalg.norm(quaternions, axis=1)
    good = np.isfinite(length) & (np.abs(length - 1.0) < 0.1)
    if not good.any():
        raise InputError(path, "holds no attitude", "the estimator never started; log a flight")
    order = np.flatnonzero(good)[np.argsort(times_s[good], kind="stable")]
    return AttitudeLog(
        times_s[order],
        quaternions[order] / length[order, None],
        _heights(log, times_s[order]),
        unix_start_s=_unix_start(log, float(times_s[order[0]])),
        notes=_notes(log),
    )


def _topic(log: Any, name: str) -> dict[str, NDArray[Any]] | None:
    """The first instance's columns of numbers; None where it has no times."""
    for one in log.data_list:
        columns = {key: values for key, values in one.data.items() if values.dtype.kind in "buif"}
        if one.name == name and len(columns.get("timestamp", ())):
            return columns
    return None


def _heights(log: Any, times_s: Floats) -> Floats | None:
    """Distance to the ground where it was measured; the height over the start is not the same and is left."""
    position = _topic(log, "vehicle_local_position")
    if position is None or not {"dist_bottom", "dist_bottom_valid"} <= set(position):
        return None
    measured = np.where(position["dist_bottom_valid"] > 0, position["dist_bottom"].astype(np.float64), np.nan)
    if not np.isfinite(measured).any():
        return None
    return np.interp(times_s, position["timestamp"] * 1e-6, measured, left=np.nan, right=np.nan)


def _unix_start(log: Any, start_s: float) -> float | None:
    gps = _topic(log, "vehicle_gps_position")
    if gps is None or "time_utc_usec" not in gps:
        return None
    known = np.flatnonzero(gps["time_utc_usec"] > 0)
    if not len(known):
        return None
    return float(gps["time_utc_usec"][known[0]] * 1e-6 - gps["timestamp"][known[0]] * 1e-6) + start_s


def _notes(log: Any) -> tuple[str, ...]:
    notes = []
    if log.file_corruption:
        notes.append("The log is damaged in places, as when the power goes; the rest is used.")
    if log.dropouts:
        lost_ms = sum(dropout.duration for dropout in log.dropouts)
        notes.append(
            f"The log has {len(log.dropouts)} dropouts, {lost_ms} ms in all; frames in them are left out."
        )
    return tuple(notes)

"""Logs of autopilots, cameras and phones, a few hundred bytes each, written by hand."""

import random
import struct
from pathlib import Path

from fuzz.kind import Case
from fuzz.mutations import damaged
from horizon_dl.logs.attitude_logs import klv
from horizon_dl.logs.attitude_logs.registry import read_attitude_log

PHONE_TIME = 1_700_000_000_000_000_000


def ulog_bytes() -> bytes:
    """PX4's log: definitions of two topics and twenty messages of each."""

    def message(kind: bytes, content: bytes) -> bytes:
        return struct.pack("<Hc", len(content), kind) + content

    parts = [b"ULog\x01\x12\x35\x01" + struct.pack("<Q", 0), message(b"B", bytes(40))]
    parts.append(message(b"F", b"vehicle_attitude:uint64_t timestamp;float[4] q;"))
    fields = b"uint64_t timestamp;float dist_bottom;bool dist_bottom_valid;uint8_t[3] _padding0;"
    parts.append(message(b"F", b"vehicle_local_position:" + fields))
    parts.append(message(b"I", b"\x11char[3] sys_namePX4"))
    parts.append(message(b"A", struct.pack("<BH", 0, 0) + b"vehicle_attitude"))
    parts.append(message(b"A", struct.pack("<BH", 0, 1) + b"vehicle_local_position"))
    for index in range(20):
        stamp = 1_000_000 + 50_000 * index
        parts.append(message(b"D", struct.pack("<HQ4f", 0, stamp, 1.0, 0.0, 0.01 * index, 0.0)))
        parts.append(message(b"D", struct.pack("<HQfB", 1, stamp, 1.5, 1)))
    parts.append(message(b"O", struct.pack("<H", 120)))
    return b"".join(parts)


def dataflash_bytes() -> bytes:
    """ArduPilot's log: formats, attitudes, a range finder and GPS."""
    formats = {
        128: ("FMT", "BBnNZ", "Type,Length,Name,Format,Columns", 86),
        10: ("ATT", "Qfff", "TimeUS,Roll,Pitch,Yaw", 20),
        11: ("RFND", "QfBB", "TimeUS,Dist,Stat,Orient", 14),
        12: ("GPS", "QIH", "TimeUS,GMS,GWk", 14),
    }
    parts = []
    for number, (name, letters, columns, size) in formats.items():
        texts = struct.pack("<4s16s64s", name.encode(), letters.encode(), columns.encode())
        parts.append(b"\xa3\x95\x80" + struct.pack("<BB", number, size + 3) + texts)
    for index in range(20):
        stamp = 1_000_000 + 100_000 * index
        parts.append(b"\xa3\x95\x0a" + struct.pack("<Qfff", stamp, index, 1.5, 359.0))
        parts.append(b"\xa3\x95\x0b" + struct.pack("<QfBB", stamp, 1.5, 4, 25))
        parts.append(b"\xa3\x95\x0c" + struct.pack("<QIH", stamp, 1000 * index, 2200))
    return b"".join(parts)


def dataflash_text() -> bytes:
    formats = [
        "FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns",
        "FMT, 10, 30, ATT, Qfff, TimeUS,Roll,Pitch,Yaw",
        "FMT, 11, 30, CAM, Qfff, TimeUS,Roll,Pitch,Yaw",
    ]
    rows = [f"ATT, {1000000 + 100000 * n}, {n}, 1.5, 359.0" for n in range(10)]
    return "\n".join([*formats, *rows, "CAM, 1450000, 4.6, 1.4, 358.0", ""]).encode()


def subtitles() -> bytes:
    """DJI's, with the gimbal's angles."""
    blocks = [
        f'{n + 1}\n00:00:00,{40 * n:03d} --> 00:00:00,{40 * n + 40:03d}\n<font size="28">FrameCnt: {n + 1}\n'
        f"[rel_alt: 5.4 abs_alt: -124.7] [gb_yaw: -162.8 gb_pitch: -{n}.5 gb_roll: 0.0] "
        "[pp_current:0.000, 0.000, 0.000, 0.000]</font>\n"
        for n in range(10)
    ]
    return "\n".join(blocks).encode()


def mars_table() -> bytes:
    """MARS logger's inertial sensors."""
    header = "Timestamp[nanosec],gx[rad/s],gy[rad/s],gz[rad/s],ax[m/s^2],ay[m/s^2],az[m/s^2]"
    rows = [f"{28670386486113 + 10_000_000 * n},-0.07,-0.07,-0.04,-0.02,9.87,1.75" for n in range(40)]
    return "\n".join([header, *rows]).encode()


def phone_table(*values: float) -> bytes:
    """One of Sensor Logger's."""
    row = ",".join(map(str, values))
    rows = [f"{PHONE_TIME + 10**7 * n},{n / 100},{row}" for n in range(20)]
    return "\n".join(["time,seconds_elapsed,z,y,x", *rows]).encode()


def write_phone(folder: Path) -> dict[str, bytes]:
    """Sensor Logger's tables in a folder, by their names."""
    folder.mkdir(parents=True, exist_ok=True)
    whole = {
        "Gravity.csv": phone_table(1.7, 9.66, 0.0),
        "TotalAcceleration.csv": phone_table(1.7, 9.66, 0.0),
        "Gyroscope.csv": phone_table(0.01, 0.02, 0.0),
        "Metadata.csv": b"version,platform,standardisation\n2,iOS,false\n",
    }
    for name, content in whole.items():
        (folder / name).write_bytes(content)
    return whole


def one_log(folder: Path, name: str, contents: list[bytes]) -> Case:
    """A log that is one file."""
    folder.mkdir(parents=True)
    path = folder / name
    for content in contents:
        path.write_bytes(content)
        read_attitude_log(path)

    def case(chance: random.Random) -> None:
        path.write_bytes(damaged(chance.choice(contents), chance))
        log = read_attitude_log(path)
        log.header("a", chance.choice((0.2, 1e300, float(log.times_s[0]))), (0.0, 0.0, 0.0))

    return case


def phone_log(folder: Path) -> Case:
    """Sensor Logger's folder, now and then without gravity."""
    whole = write_phone(folder)
    read_attitude_log(folder)

    def case(chance: random.Random) -> None:
        changed = [chance.choice(sorted(whole))]
        (folder / changed[0]).write_bytes(damaged(whole[changed[0]], chance))
        if chance.random() < 0.3:
            (folder / "Gravity.csv").unlink()
            changed.append("Gravity.csv")
        try:
            read_attitude_log(folder)
        finally:
            for name in changed:
                (folder / name).write_bytes(whole[name])

    return case


def _item(key: bytes, kind: bytes, size: int, count: int, data: bytes) -> bytes:
    return key + kind + struct.pack(">BH", size, count) + data + b"\0" * (-len(data) % 4)


def _held(key: bytes, data: bytes) -> bytes:
    return _item(key, b"\0", 1, len(data), data)


def gopro_packet() -> bytes:
    """A second of a GoPro's sensors: gravity, orientation, gyroscope, accelerometer."""
    scale = _item(b"SCAL", b"s", 2, 1, struct.pack(">h", 100))
    axes = _item(b"ORIN", b"c", 1, 3, b"ZXY")

    def stream(key: bytes, rows: list[tuple[int, ...]], *before: bytes) -> bytes:
        values = [value for row in rows for value in row]
        data = struct.pack(f">{len(values)}h", *values)
        return _held(b"STRM", b"".join(before) + _item(key, b"s", 2 * len(rows[0]), len(rows), data))

    return _held(
        b"DEVC",
        stream(b"GRAV", [(0, 99, 5)] * 10, scale)
        + stream(b"IORI", [(100, 0, 1, 0)] * 10, scale)
        + stream(b"GYRO", [(1, 2, 3)] * 20, scale, axes)
        + stream(b"ACCL", [(3, 981, 20)] * 20, scale, axes),
    )


def gopro_items(_: Path) -> Case:
    """GoPro's packets by themselves."""
    whole = gopro_packet()
    assert [sorted(one)[0] for one in klv.streams(whole)] == ["GRAV", "IORI", "GYRO", "ACCL"]

    def case(chance: random.Random) -> None:
        for stream in klv.streams(damaged(whole, chance)):
            for key in stream:
                klv.samples(stream, key)
                klv.text(stream, key)

    return case

"""Tables: `frames.csv` and attitude logs in all the dialects that people write."""

import random
from pathlib import Path

import make_sets

from fuzz.kind import Case
from fuzz.mutations import damaged
from horizon_dl.data.attitude_log import AttitudeLog
from horizon_dl.data.given import Given
from horizon_dl.errors import FrameError
from horizon_dl.logs.attitude_logs.registry import read_attitude
from horizon_dl.readers.registry import open_recording

Rows = list[tuple[float, ...]]
ANGLES: Rows = [(5 + t / 10, 0.1 * (t % 3), -0.2 + t / 50, t / 7, 1.5) for t in range(8)]
QUATERNIONS: Rows = [(5 + t / 10, 1.0, 0.0, 0.1 * (t % 2), 0.0) for t in range(8)]
INERTIAL: Rows = [(t / 100, 0.1, -0.2, 0.01 * (t % 5), 0.1, 0.2, 9.8) for t in range(60)]
UNIX = 1_600_000_000


def _text(header: str, rows: Rows, separator: str = ",", decimal: str = ".", image: bool = False) -> str:
    """A table; its first column holds pictures' names where wanted."""
    lines = ["image" + separator + header if image else header]
    for index, row in enumerate(rows):
        cells = [f"{value:g}" if abs(value) < 1e5 else f"{value:.0f}" for value in row]
        names = [f"images/{index % 2}.png"] if image else []
        lines.append(separator.join([*names, *(cell.replace(".", decimal) for cell in cells)]))
    return "\n".join(lines) + "\n"


def _scaled(rows: Rows, *factors: float, add: float = 0.0) -> Rows:
    scaled = [tuple(value * factor for value, factor in zip(row, factors, strict=True)) for row in rows]
    return [(row[0] + add, *row[1:]) for row in scaled]


def _dialects(image: bool) -> list[bytes]:
    degrees = _scaled(ANGLES, 1, 57.3, 57.3, 57.3, 1)
    unix_ms = _scaled(degrees, 1e3, 1, 1, 1, 1, add=UNIX * 1e3)
    dates = "time,roll_deg,pitch_deg\n" + "".join(f"2024-05-01T12:00:0{t}.5Z,1.5,-{t}\n" for t in range(8))
    texts = [
        _text("time_s,roll_rad,pitch_rad,yaw_rad,height_m", ANGLES, image=image),
        _text("time;phi_deg;theta_deg;psi_deg;agl", degrees, ";", ",", image),
        _text("timestamp [ms]\tRoll (°)\tPitch (°)\tHeading (°)\tAGL (ft)", degrees, "\t", image=image),
        _text("timestamp,roll,pitch,yaw,height", unix_ms, image=image),
        _text("t,qw,qx,qy,qz", QUATERNIONS, image=image),
        _text("header_stamp | q_w | q_x | q_y | q_z", QUATERNIONS, " | ", image=image),
        "sep=;\n# a\n" + _text("time_s;roll_rad;pitch_rad;yaw_rad;height_cm", ANGLES, ";", ",", image),
    ]  # fmt: skip
    if not image:
        texts.append(_text("time_s,gx_rad_s,gy_rad_s,gz_rad_s,ax,ay,az", INERTIAL))
    encoded = [text.encode() for text in texts]
    return [*encoded, texts[0].encode("utf-16"), *([] if image else [dates.encode()])]


def _units(chance: random.Random, **given: object) -> Given:
    return Given(
        time_unit=chance.choice((None, None, "s", "ms", "ns")),
        angle_unit=chance.choice((None, None, "deg", "rad")),
        imu_axes=chance.choice((None, "flu", "frd")),
        **given,
    )


def attitude_table(folder: Path) -> Case:
    """A log as a table, or two angles for ever."""
    folder.mkdir(parents=True)
    path = folder / "log.csv"
    whole = _dialects(image=False)
    for content in whole:
        path.write_bytes(content)
        read_attitude(str(path), Given(time_unit="s", angle_unit="rad", imu_axes="flu"))

    def case(chance: random.Random) -> None:
        if chance.random() < 0.1:
            read_attitude(damaged(b"constant:0.5,-12.5", chance).decode(errors="replace"))
            return
        path.write_bytes(damaged(chance.choice(whole), chance))
        log = read_attitude(str(path), _units(chance))
        log.header("a", chance.choice((0.5, 5.3, 1e300, -1.0, float("nan"))), (0.0, 0.0, 0.0))
        if isinstance(log, AttitudeLog):
            log.on_clock(chance.choice((0.0, 1e300, -5.0)), 100.0)

    return case


def frames_table(folder: Path) -> Case:
    """A set's own table, by itself or with a log beside it."""
    folder.mkdir(parents=True)
    for index in range(2):
        make_sets.save_image(folder / "images" / f"{index}.png")
    camera = folder / "camera.yaml"
    camera.write_text(make_sets.CAMERA_YAML)
    path, log = folder / "frames.csv", folder.parent / "log_of_frames.csv"
    log.write_bytes(_dialects(image=False)[0])
    whole = [*_dialects(image=True), _text("time_s", [row[:1] for row in ANGLES], image=True).encode()]

    def case(chance: random.Random) -> None:
        path.write_bytes(damaged(chance.choice(whole), chance))
        given = _units(chance, attitude=str(log) if chance.random() < 0.2 else None)
        for index, frame in enumerate(open_recording(folder, given=given).frames()):
            assert isinstance(frame, FrameError) or frame.image.shape == (24, 32, 3)
            if index == 1:
                break

    return case

"""Recordings whose attitude is in or beside them: phones, GoPro, DJI; and public sets."""

from fractions import Fraction
from pathlib import Path

import make_films
import make_sets
import numpy as np
from PIL import Image

from fuzz.logs import gopro_packet, mars_table, write_phone
from horizon_dl.geometry.attitude import rotation_from_rpy

NANOSECONDS = 28670386486113


def kitti_odometry(folder: Path) -> Path:
    """One sequence of three images with its poses."""
    sequence = folder / "sequences" / "07"
    rows = []
    for index, roll in enumerate((0.1, -0.1, 0.1)):
        make_sets.save_image(sequence / "image_2" / f"{index:06d}.png")
        pose = np.column_stack([rotation_from_rpy(0.0, 0.0, roll), [index, 0, 0]])
        rows.append(" ".join(map(str, pose.ravel())))
    (sequence / "times.txt").write_text("0.0e+00\n1.0e-01\n2.0e-01\n")
    projection = "30 0 15.5 4 0 30 11.5 0 0 0 1 0"
    (sequence / "calib.txt").write_text("".join(f"P{n}: {projection}\n" for n in range(4)))
    (sequence / "poses.txt").write_text("\n".join(rows))
    return sequence


def tartanair(folder: Path) -> Path:
    """Three images with poses, depth and times."""
    for index in range(3):
        make_sets.save_image(folder / "image_left" / f"{index:06d}_left.png")
        (folder / "depth_left").mkdir(exist_ok=True)
        np.save(folder / "depth_left" / f"{index:06d}_left_depth.npy", np.full((24, 32), 2.0, np.float32))
    (folder / "pose_left.txt").write_text("1 2 -3 0.1 0 0 0.995\n" * 3)
    (folder / "imu").mkdir()
    np.save(folder / "imu" / "cam_time.npy", np.arange(3) / 10)
    return folder


def dji_photos(folder: Path) -> Path:
    """Two photos with the gimbal's angles in their XMP."""
    folder.mkdir(parents=True)
    tags = (
        '<x:xmpmeta><rdf:Description drone-dji:GimbalRollDegree="+0.00" drone-dji:GimbalYawDegree="-12.30" '
        'drone-dji:GimbalPitchDegree="-29.90" drone-dji:CalibratedFocalLength="30.0" '
        'drone-dji:CalibratedOpticalCenterX="15.5" drone-dji:CalibratedOpticalCenterY="11.5"/></x:xmpmeta>'
    )
    exif = Image.Exif()
    exif.get_ifd(0x8769)[36867] = "2024:05:01 12:00:00"
    exif.get_ifd(0x8769)[41989] = 24
    for index in range(2):
        image = Image.fromarray(np.full((24, 32, 3), 90, np.uint8))
        image.save(folder / f"DJI_{index:04d}.JPG", exif=exif, xmp=tags.encode())
    return folder


def mars(folder: Path) -> Path:
    """MARS logger's folder: a film of ten frames and three tables."""
    folder.mkdir(parents=True)
    make_films.film(folder / "movie.mp4", range(0, 330, 33), size=(32, 24), codec="mpeg4")
    stamps = [NANOSECONDS + 33_000_000 * n for n in range(12)]
    (folder / "gyro_accel.csv").write_bytes(mars_table())
    rows = [f"{stamp},{1663406448280000000 + stamp}" for stamp in stamps]
    header = "Frame timestamp[nanosec],Unix time[nanosec]"
    (folder / "frame_timestamps.txt").write_text("\n".join([header, *rows]))
    header = "Timestamp[nanosec],fx[px],fy[px],Frame No.,Exposure time[nanosec],Frame readout time[nanosec]"
    rows = [f"{stamp},30.5,30.5,{n},10000000,20733000" for n, stamp in enumerate(stamps)]
    (folder / "movie_metadata.csv").write_text("\n".join([header, *rows]))
    return folder


def sensor_logger(folder: Path) -> Path:
    """Sensor Logger's folder with a film."""
    write_phone(folder)
    (folder / "Camera").mkdir()
    make_films.film(folder / "Camera" / "1700000000000.mp4", range(0, 160, 33), size=(32, 24), codec="mpeg4")
    (folder / "Camera" / "camera.yaml").write_text(make_sets.CAMERA_YAML)
    return folder


def gopro(folder: Path) -> Path:
    """A film with a track of a GoPro's name; its packets travel as another codec's, which nobody decodes."""
    import av

    folder.mkdir(parents=True)
    path = folder / "GX010001.mp4"
    with av.open(str(path), "w") as container:
        film = container.add_stream("mpeg4", rate=10)
        film.width, film.height, film.pix_fmt = 32, 24, "yuv420p"
        track = container.add_stream("mp3")
        track.metadata["handler_name"] = "GoPro MET"
        for number in range(5):
            image = av.VideoFrame.from_ndarray(make_films.picture(number, 32, 24), format="rgb24")
            container.mux(film.encode(image))
            packet = av.Packet(gopro_packet())
            packet.stream, packet.time_base = track, Fraction(1, 1000)
            packet.pts = packet.dts = number * 100
            container.mux(packet)
        container.mux(film.encode())
    (folder / "camera.yaml").write_text(make_sets.CAMERA_YAML)
    return path

"""What is fuzzed: for each kind of input a real one, and what reads it."""

from functools import partial
from pathlib import Path

import make_sets

from fuzz import artefacts, logs, sets, settings, tables
from fuzz.cameras import camera_file
from fuzz.kind import Target, reader
from fuzz.streams import film, ros_bag
from fuzz.vehicle import mavlink

SETS = {
    "images_csv": make_sets.images_csv,
    "kitti": make_sets.kitti,
    "paparazzi": make_sets.paparazzi,
    "tum": make_sets.tum,
    "euroc": make_sets.euroc,
    "euroc_truth": partial(make_sets.euroc, truth=True),
    "kitti_odometry": sets.kitti_odometry,
    "tartanair": sets.tartanair,
    "dji_photos": sets.dji_photos,
}
FILMS = {"mars": sets.mars, "sensor_logger": sets.sensor_logger, "gopro": sets.gopro}
LOGS = {
    "ulog": ("a.ulg", [logs.ulog_bytes]),
    "dataflash": ("a.bin", [logs.dataflash_bytes, logs.dataflash_text]),
    "srt": ("a.srt", [logs.subtitles]),
    "mars_log": ("gyro_accel.csv", [logs.mars_table]),
}


def targets(place: Path) -> list[Target]:
    """All of them, with their material in a folder of their own."""

    def target(name: str, share: float, maker: object, *more: object) -> Target:
        return Target(name, share, partial(maker, place / name, *more))

    return [
        *(target(name, 4, reader, make) for name, make in SETS.items()),
        *(target(name, 1.5, reader, make) for name, make in FILMS.items()),
        *(
            target(name, 5, logs.one_log, file, [make() for make in makers])
            for name, (file, makers) in LOGS.items()
        ),
        target("phone_log", 5, logs.phone_log),
        target("gopro_items", 5, logs.gopro_items),
        target("mavlink", 12, mavlink),
        target("attitude_table", 10, tables.attitude_table),
        target("frames_table", 10, tables.frames_table),
        target("camera_file", 12, camera_file),
        target("image", 10, settings.image),
        target("config", 8, settings.config),
        Target("override", 8, settings.override),
        target("archive", 4, settings.archive),
        target("checkpoint", 6, artefacts.checkpoint),
        target("manifest", 5, artefacts.manifest),
        target("sums", 2, artefacts.sums),
        target("run_folder", 2, artefacts.run_folder),
        target("model_file", 3, artefacts.model_file),
        target("card", 0.5, artefacts.card),
        target("film", 1.5, film),
        target("ros_bag", 1, ros_bag),
    ]

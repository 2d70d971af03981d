"""How well roll and pitch are told by pictures alone: by edges and skylines, and by a trained net's map.

python benchmarks/attitude_from_images.py DATA... [--learn] [--frames 24]

For each set: the share of the frames in which `--attitude from-images` dares to tell up, the median angle to
the recording's own up there, and that over all frames. With --learn also a net trained on the first half of
the recording, whose map of what is above is fitted by a horizon in frames of the second half, their attitude
not known to it. Recorded attitudes have errors of their own: some degrees on the hallway and the room.
"""

import argparse
import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from horizon_dl.config import load_config
from horizon_dl.data.from_images import MOST_DOUBT_RAD, up_from_picture
from horizon_dl.data.source import Recording
from horizon_dl.geometry.horizon_line import up_from_map
from horizon_dl.geometry.rays import camera_rays
from horizon_dl.geometry.tilts import UpEstimate
from horizon_dl.readers.registry import open_recording
from horizon_dl.training.predict import predict
from horizon_dl.training.train import train_run

Found = tuple[float, float]


def error_and_doubt(found: UpEstimate | None, up_cam: np.ndarray) -> Found:
    """Both in degrees; 90 where nothing was found."""
    if found is None:
        return 90.0, 90.0
    angle = math.acos(float(np.clip(found.up_cam @ up_cam, -1, 1)))
    return math.degrees(angle), math.degrees(found.sd_rad)


def told(rows: Sequence[Found]) -> str:
    table = np.array(rows)
    sure = table[table[:, 1] <= math.degrees(MOST_DOUBT_RAD), 0]
    median = f"{np.median(sure):5.1f}" if len(sure) else "    -"
    return f"told {len(sure) / len(table):4.0%}, median {median}; all {np.median(table[:, 0]):5.1f} degrees"


def evenly(indices: Sequence[int], count: int) -> list[int]:
    return sorted({indices[int(k)] for k in np.linspace(0, len(indices) - 1, count)})


def by_net(recording: Recording, usable: Sequence[int], count: int) -> list[Found]:
    half = len(usable) // 2
    run = train_run(recording.select(usable[:half]), load_config(None, []))
    rows = []
    for index in evenly(usable[half:], count):
        frame = recording.read(index, with_truth=False)
        assert frame.up_cam is not None
        p_above = predict(run, frame).measures.p_above
        height, width = p_above.shape
        rays = camera_rays(recording.calibrated.scaled(width, height)).directions
        rows.append(error_and_doubt(up_from_map(p_above[::6, ::6], rays[::6, ::6]), frame.up_cam))
    return rows


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("data", nargs="+", type=Path)
    parser.add_argument("--learn", action="store_true")
    parser.add_argument("--frames", type=int, default=24)
    arguments = parser.parse_args()
    for path in arguments.data:
        recording = open_recording(path)
        usable = [index for index, header in enumerate(recording.headers) if header.up_cam is not None]
        rows = []
        for index in evenly(usable, arguments.frames):
            frame = recording.read(index, with_truth=False)
            assert frame.up_cam is not None
            rows.append(error_and_doubt(up_from_picture(frame), frame.up_cam))
        print(f"{recording.name:<28} pictures: {told(rows)}", flush=True)
        if arguments.learn:
            print(f"{'':<28} net's map: {told(by_net(recording, usable, arguments.frames))}", flush=True)


if __name__ == "__main__":
    main()

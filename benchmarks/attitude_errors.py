"""What does a wrong attitude do in flight? Tilted, rolled, late and frozen ones, late and mirrored pictures.

    HORIZON_DL_DATA=... python benchmarks/attitude_errors.py --nets nets/ [--set embedded ...]

The nets are those of `safety.py`; flown are the frames that they were not trained on, in their order. Counted
are the sectors that hold an obstacle with the right attitude and evidence: how many of them are called free,
and how many are free or over 1.5 times as far away.
"""

import argparse
from collections.abc import Callable, Iterable
from dataclasses import replace
from itertools import chain
from pathlib import Path

import numpy as np
from nets import all_sets, open_set
from numpy.typing import NDArray
from safety import LEFT_OUT, trained_model

from horizon_dl.data.frame import Frame
from horizon_dl.metrics.ranging import MISSED_FACTOR
from horizon_dl.ranging.sectors import FreeDistances, Outcome
from horizon_dl.runtime.model import ObstacleModel
from horizon_dl.runtime.perception import Perception

Flight = list[Frame]
PITCHES_DEG = (-3, -6, -10, 3, 6, 10)
"""Of the attitude over the true one; negative ones take the camera to look further up than it does."""
ROLLS_DEG = (3, 6, 12)
LATE = (1, 3, 10)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    sets = all_sets()
    parser.add_argument("--nets", type=Path, required=True, help="folder of the trained nets")
    parser.add_argument("--set", nargs="*", choices=sets, default=sets)
    arguments = parser.parse_args()
    print("| set | error | frames believed | free | free or too far |\n| --- | --- | ---: | ---: | ---: |")
    for name in arguments.set:
        model = ObstacleModel.load(trained_model(name, open_set(name), arguments.nets))
        flights = left_out_flights(name)
        right = [flown(model, flight) for flight in flights]
        for title, spoil in errors().items():
            wrong = [flown(model, spoil(flight)) for flight in flights]
            print(f"| {name} | {title} | {row(right, wrong)} |", flush=True)


def left_out_flights(name: str) -> list[Flight]:
    """The frames with attitude that the net was not trained on, a list for each stretch."""
    recording = open_set(name)
    known = [i for i, header in enumerate(recording.headers) if header.up_cam is not None]
    parts = ([i for i in known if 10 * i // recording.length == part] for part in LEFT_OUT)
    return [[recording.read(i, with_truth=False) for i in part] for part in parts]


def errors() -> dict[str, Callable[[Flight], Flight]]:
    """By title."""
    tilts = {f"pitch {angle:+d} deg": _turned(0, angle) for angle in PITCHES_DEG}
    rolls = {f"roll {angle:+d} deg": _turned(2, angle) for angle in ROLLS_DEG}
    late = {f"attitude {count} frames late": _late_attitude(count) for count in LATE}
    return {
        "none": lambda flight: flight,
        **tilts,
        **rolls,
        **late,
        "attitude of the first frame": lambda flight: [
            replace(one, up_cam=flight[0].up_cam) for one in flight
        ],
        "pictures 5 frames late": _late_pictures,
        "mirrored": lambda flight: [
            replace(one, image=np.ascontiguousarray(one.image[:, ::-1])) for one in flight
        ],
    }


def flown(model: ObstacleModel, flight: Iterable[Frame]) -> list[tuple[bool, FreeDistances]]:
    """Whether each frame was believed, and its sectors."""
    perception = Perception.of(model, (0.0, 0.0, 0.0), frames=1)
    results = []
    for frame in flight:
        assert frame.up_cam is not None
        found = perception.look(frame.time_s, frame.image, frame.up_cam, 0.0, frame.height_m or 1.0)
        results.append((perception.judged is not None and not perception.judged.reasons, found))
    return results


def row(right: list[list[tuple[bool, FreeDistances]]], wrong: list[list[tuple[bool, FreeDistances]]]) -> str:
    """Of a table."""
    frames = believed = obstacles = free = far = 0
    for (_, true), (trusted, found) in zip(chain(*right), chain(*wrong), strict=True):
        there = true.outcome == Outcome.OBSTACLE
        called_free = there & (found.outcome == Outcome.FREE)
        too_far = found.distance_m > MISSED_FACTOR * true.distance_m
        frames, believed = frames + 1, believed + trusted
        obstacles, free = obstacles + int(there.sum()), free + int(called_free.sum())
        far += int((called_free | (there & (found.outcome == Outcome.OBSTACLE) & too_far)).sum())
    return f"{believed} of {frames} | {free / max(1, obstacles):.3f} | {far / max(1, obstacles):.3f}"


def _turned(axis: int, angle_deg: float) -> Callable[[Flight], Flight]:
    """Attitudes turned about an optical axis: 0 right, 2 forward."""
    cos, sin = np.cos(np.radians(angle_deg)), np.sin(np.radians(angle_deg))
    turn: NDArray[np.float64] = np.eye(3)
    first, second = (axis + 1) % 3, (axis + 2) % 3
    turn[[first, first, second, second], [first, second, first, second]] = cos, -sin, sin, cos
    return lambda flight: [replace(one, up_cam=turn @ np.asarray(one.up_cam)) for one in flight]


def _late_attitude(count: int) -> Callable[[Flight], Flight]:
    return lambda flight: [
        replace(one, up_cam=flight[max(0, i - count)].up_cam) for i, one in enumerate(flight)
    ]


def _late_pictures(flight: Flight) -> Flight:
    return [replace(one, image=flight[max(0, i - 5)].image) for i, one in enumerate(flight)]


if __name__ == "__main__":
    main()

"""Does free space appear where none was seen? Made-up and degraded pictures on real nets, and what it costs.

    HORIZON_DL_DATA=... python benchmarks/safety.py --nets nets/ --out safety.json [--set embedded ...]

For each set a net is trained (once: it is kept in --nets) on all frames but the fourth and the eighth tenth,
exported, and flown on, by the same way from picture to sectors as in flight. Counted are sectors of 1.25 deg.
In pictures that show nothing, or not what is before the vehicle, no sector may be free. In degraded ones none
may be free (`clear`), or farther than 1.5 times the truth (`too far`), where the truth has an obstacle, or
where the picture is lost. What it costs is counted on the frames that were left out.

The limits were chosen on the embedded set and the corridor, one of them on the arena, too; hallway and KITTI
only score.
"""

import argparse
import json
import os
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from nets import open_set, set_names
from numpy.typing import NDArray
from safety_pictures import PICTURES, Scene, Spoiled

from horizon_dl.config import load_config
from horizon_dl.data.evenly import evenly
from horizon_dl.data.frame import Frame, Truth
from horizon_dl.data.source import Recording
from horizon_dl.evidence.judge import Judge
from horizon_dl.export.export import export_run
from horizon_dl.geometry.polar import PolarView, polar_view
from horizon_dl.geometry.resize import nearest
from horizon_dl.metrics.range_truth import level_ranges, true_distances
from horizon_dl.metrics.ranging import MISSED_FACTOR, RangingAccumulator
from horizon_dl.output import write_json
from horizon_dl.provenance import machine, versions
from horizon_dl.ranging.free_distance import free_distances
from horizon_dl.ranging.sectors import FreeDistances, Outcome
from horizon_dl.ranging.temporal_filter import SectorFilter
from horizon_dl.readers.registry import open_recording
from horizon_dl.runtime.model import ObstacleModel
from horizon_dl.runtime.perception import Perception
from horizon_dl.training.run_folder import save_run
from horizon_dl.training.train import train_run

LEFT_OUT = (3, 7)
FURTHER_PLACES = ("room", "icl_office_kt3", "gopro_max_path")
LOST_SHARE = 0.3
"""A sector with more than this share of its ground lost must not be free."""
FROZEN_FRAMES = 12

Sectors = NDArray[np.bool_]


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--nets", type=Path, required=True, help="folder for the trained nets")
    parser.add_argument("--out", type=Path, default=Path("safety.json"))
    parser.add_argument("--set", nargs="*", choices=set_names(), default=set_names())
    parser.add_argument("--frames", type=int, default=6, help="frames that each picture is made of")
    arguments = parser.parse_args()
    found: dict[str, Any] = {}
    for name in arguments.set:
        start = time.monotonic()
        found[name] = safety_figures(name, arguments.nets, arguments.frames)
        print(f"{name}: {time.monotonic() - start:.0f} s")
        print(json.dumps({key: found[name][key] for key in ("kinds", "cost")}, indent=1), flush=True)
    write_json(arguments.out, {"sets": found, "versions": versions(), "machine": machine()})


def safety_figures(name: str, folder: Path, frames: int) -> dict[str, Any]:
    """All figures of one set."""
    recording = open_set(name)
    known = [i for i, header in enumerate(recording.headers) if header.up_cam is not None]
    left_out = [i for i in known if 10 * i // recording.length in LEFT_OUT]
    model = ObstacleModel.load(trained_model(name, recording, folder))
    perception = Perception.of(model, (0.0, 0.0, 0.0), frames=1)
    labelled = [i for i in left_out if recording.headers[i].labelled]
    labelled = labelled or [i for i in known if recording.headers[i].labelled]
    pictures = picture_figures(name, recording, perception, evenly(labelled, frames))
    return {
        "pictures": pictures,
        "kinds": {kind: _pooled(pictures, kind) for kind in ("nothing", "not there", "degraded")},
        "cost": cost_figures(recording, perception, left_out),
    }


def trained_model(name: str, recording: Recording, folder: Path) -> Path:
    """The exported net of a set, trained if it was not yet."""
    run_folder = folder / name
    path = run_folder / "model.onnx"
    if not path.exists():
        run_folder.mkdir(parents=True, exist_ok=True)
        kept = [i for i in range(recording.length) if 10 * i // recording.length not in LEFT_OUT]
        run = train_run(recording.select(kept), load_config(None, []), progress=True)
        save_run(run_folder, run)
        export_run(run, recording.calibrated).write(run_folder)
    return path


def picture_figures(
    name: str, recording: Recording, perception: Perception, indices: list[int]
) -> dict[str, dict[str, Any]]:
    """For each picture: its kind, sectors in view, and the shares that are free and should not be."""
    others = {other: _middle_frame(other) for other in (*set_names(), *FURTHER_PLACES)}
    counts: dict[str, NDArray[np.int64]] = {}
    for index in indices:
        frame = recording.read(index)
        later = recording.read(min(index + 5, recording.length - 1)).image
        scene = Scene(frame.image, _floor(frame, perception), later, others)
        rng = np.random.default_rng(index)
        pictures: dict[str, tuple[str, Callable[[Scene, np.random.Generator], Spoiled]]] = {
            "as it is": ("degraded", lambda scene, _: Spoiled(scene.image)),
            **PICTURES,
        }
        for title, (kind, make) in pictures.items():
            if title.endswith(f": {name}"):
                continue
            spoiled = make(scene, rng)
            counts[title] = counts.get(title, np.zeros(6, np.int64)) + _counted(
                perception, frame, spoiled, kind
            )
    counts["frozen while the attitude moves"] = _frozen(recording, perception, indices)
    kinds = {"as it is": "reference", "frozen while the attitude moves": "not there"}
    return {
        title: {"kind": kinds.get(title) or PICTURES[title][0], **_shares(count)}
        for title, count in counts.items()
    }


def _counted(perception: Perception, frame: Frame, spoiled: Spoiled, kind: str) -> NDArray[np.int64]:
    """Sectors in view; believed; clear and too far with evidence, and without."""
    polar = _polar(perception, frame)
    with_evidence, without = _looked(perception, replace(frame, image=spoiled.image), polar)
    wrong = [
        _wrong(frame, found, polar, spoiled, in_degraded=kind == "degraded")
        for found in (with_evidence, without)
    ]
    in_view = polar.pixels.sum(axis=1) > 0
    known = (with_evidence.outcome != Outcome.UNKNOWN) & in_view
    return np.array([in_view.sum(), known.sum(), *(part.sum() for pair in wrong for part in pair)])


def _looked(
    perception: Perception, frame: Frame, polar: PolarView, *, fresh: bool = True
) -> tuple[FreeDistances, FreeDistances]:
    """Sectors with evidence and without; `fresh` forgets the frames before."""
    assert frame.up_cam is not None
    perception.filter = SectorFilter(1)
    if fresh:
        perception.judge = Judge(perception.model.camera, perception.model.place)
    floor = frame.floor_up_cam
    found = perception.look(frame.time_s, frame.image, frame.up_cam, 0.0, frame.height_m or 1.0, floor)
    assert perception.ranged is not None
    return found, perception.ranged


def _wrong(
    frame: Frame, found: FreeDistances, polar: PolarView, spoiled: Spoiled, *, in_degraded: bool
) -> tuple[Sectors, Sectors]:
    """(sectors,) that are clear and should not be; and those that, or whose obstacle, lies too far."""
    free = found.outcome == Outcome.FREE
    if not in_degraded:
        return free, free
    blocked = np.zeros_like(free)
    too_far = np.zeros_like(free)
    if frame.truth is not None:
        truth = nearest(frame.truth, *polar.cell.shape)
        true = free_distances(truth == Truth.OBSTACLE, polar, 1.0, known=truth != Truth.IGNORE)
        blocked = true.outcome == Outcome.OBSTACLE
        reach = np.tan(np.where(found.outcome == Outcome.UNKNOWN, 1.5, found.depression_rad))
        too_far = blocked & (found.outcome != Outcome.UNKNOWN)
        too_far &= np.tan(np.nan_to_num(true.depression_rad)) > MISSED_FACTOR * np.nan_to_num(reach)
    if spoiled.lost is not None:
        lost = nearest(spoiled.lost.astype(np.uint8), *polar.cell.shape) > 0
        share = polar.counts(lost).sum(axis=1) / np.maximum(polar.pixels.sum(axis=1), 1)
        blocked |= share > LOST_SHARE
    clear = free & blocked
    return clear, clear | too_far


def _frozen(recording: Recording, perception: Perception, indices: list[int]) -> NDArray[np.int64]:
    """One picture for a second, with the attitudes of the frames that followed, turned a little more."""
    total = np.zeros(6, np.int64)
    for index in indices:
        frozen = recording.read(index)
        assert frozen.up_cam is not None
        for step in range(FROZEN_FRAMES):
            angle = np.deg2rad(1.0) * step
            tilt = np.array(
                [[1, 0, 0], [0, np.cos(angle), -np.sin(angle)], [0, np.sin(angle), np.cos(angle)]]
            )
            moved = replace(frozen, time_s=frozen.time_s + 0.1 * step, up_cam=tilt @ frozen.up_cam)
            polar = _polar(perception, moved)
            found = _looked(perception, moved, polar, fresh=step == 0)
            if step:
                free = [int((one.outcome == Outcome.FREE).sum()) for one in found]
                known = int((found[0].outcome != Outcome.UNKNOWN).sum())
                total += [len(found[0].outcome), known, free[0], free[0], free[1], free[1]]
    return total


def cost_figures(recording: Recording, perception: Perception, indices: list[int]) -> dict[str, Any]:
    """On frames that were not learned from: unknown, missed and false stops, with evidence and without."""
    accumulators = {"with": RangingAccumulator(), "without": RangingAccumulator()}
    unknown = np.zeros(3, np.int64)
    reasons: dict[str, int] = {}
    for number, frame in enumerate(_readable(recording, indices)):
        polar = _polar(perception, frame)
        found = _looked(perception, frame, polar, fresh=number == 0)
        in_view = polar.pixels.sum(axis=1) > 0
        not_known = [(one.outcome == Outcome.UNKNOWN) & in_view for one in found]
        unknown += [in_view.sum(), *(part.sum() for part in not_known)]
        for reason in perception.judged.reasons if perception.judged else ():
            reasons[str(reason)] = reasons.get(str(reason), 0) + 1
        range_m = level_ranges(frame)
        if range_m is not None and frame.truth is not None and frame.height_m is not None:
            truth_m = true_distances(frame, range_m, perception.bearings)
            for accumulator, one in zip(accumulators.values(), found, strict=True):
                accumulator.count(one, truth_m, frame.height_m)
    return {
        "frames": len(indices),
        "unknown": {"with": unknown[1] / unknown[0], "without": unknown[2] / unknown[0]},
        "frames_not_believed": reasons,
        "ranging": {name: accumulator.compute() for name, accumulator in accumulators.items()},
    }


def _readable(recording: Recording, indices: list[int]) -> Iterator[Frame]:
    for index in indices:
        yield recording.read(index)


def _polar(perception: Perception, frame: Frame) -> PolarView:
    assert frame.floor_normal is not None
    return polar_view(perception.rays, frame.floor_normal, perception.forward_cam, perception.bearings)


def _floor(frame: Frame, perception: Perception) -> NDArray[np.bool_]:
    if frame.truth is not None and (frame.truth == Truth.FLOOR).sum() > 100:
        return np.asarray(frame.truth == Truth.FLOOR)
    below = perception.model.predict(frame.image, frame.up_cam).elevation < 0
    return nearest(below.astype(np.uint8), *frame.image.shape[:2]) > 0


def _middle_frame(name: str) -> NDArray[np.uint8]:
    recording = (
        open_set(name) if name in set_names() else open_recording(Path(os.environ["HORIZON_DL_DATA"]) / name)
    )
    return recording.read(recording.length // 2).image


def _shares(count: NDArray[np.int64]) -> dict[str, Any]:
    sectors, known, *wrong = (int(number) for number in count)
    names = ("clear", "too_far", "clear_without", "too_far_without")
    return {
        "sectors": sectors,
        "believed": known / sectors,
        **{name: number / sectors for name, number in zip(names, wrong, strict=True)},
    }


def _pooled(pictures: dict[str, dict[str, Any]], kind: str) -> dict[str, Any]:
    mine = [picture for picture in pictures.values() if picture["kind"] == kind]
    total = sum(picture["sectors"] for picture in mine)
    names = ("clear", "too_far", "clear_without", "too_far_without")
    return {
        "pictures": len(mine),
        "sectors": total,
        **{name: sum(one[name] * one["sectors"] for one in mine) / total for name in names},
    }


if __name__ == "__main__":
    main()

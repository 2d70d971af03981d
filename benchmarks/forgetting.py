"""Does the learner forget? One stream: arena, corridor, arena again; with and without replay.

    HORIZON_DL_DATA=DIR python benchmarks/forgetting.py --out forgetting.json

The test frames of the protocol labelled-out, and their neighbours, are never learned from. After each part
of the stream the AUC of the entropy on them is measured, on those of both sets. `newest only` remembers one
frame.
"""

import argparse
import os
import time
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from tqdm import tqdm

from horizon_dl.config import Config, load_config
from horizon_dl.data.source import Recording
from horizon_dl.evaluation.compare import split_recording
from horizon_dl.metrics.method_accumulator import MethodAccumulator
from horizon_dl.metrics.roc import RocResult
from horizon_dl.metrics.scored_pixels import scored_pixels
from horizon_dl.output import write_json
from horizon_dl.provenance import machine, versions
from horizon_dl.readers.registry import open_recording
from horizon_dl.training.frame_store import FrameStore
from horizon_dl.training.online.learner import OnlineLearner

STREAM = ("arena", "corridor", "arena")
VARIANTS = {"64 MB": (), "8 MB": ("online.memory_mb=8",), "newest only": ("online.memory_mb=0.0001",)}
WANTED_FALL = 0.02


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--out", type=Path, default=Path("forgetting.json"))
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--every", type=int, default=1, metavar="N", help="take every Nth frame only")
    parser.add_argument("--variants", nargs="+", choices=list(VARIANTS), default=list(VARIANTS))
    arguments = parser.parse_args()
    folder = Path(os.environ["HORIZON_DL_DATA"])
    sets = {name: open_recording(folder / name) for name in set(STREAM)}
    found: dict[str, Any] = {
        "seed": arguments.seed,
        "every": arguments.every,
        "versions": versions(),
        "machine": machine(),
        "variants": {},
    }
    for name in arguments.variants:
        config = load_config(None, VARIANTS[name])
        found["variants"][name] = stages = one_stream(sets, config, arguments.seed, arguments.every)
        write_json(arguments.out, found)
        fall = stages[0]["arena"][0] - stages[1]["arena"][0]
        print(f"{name}: fall on arena's held-back frames: {fall:.3f} (wanted: at most {WANTED_FALL})")


def one_stream(sets: dict[str, Recording], config: Config, seed: int, every: int) -> list[dict[str, Any]]:
    """AUC pooled and within depression bands, by set, after each part of the stream."""
    learner = OnlineLearner(config, seed)
    stages = []
    for part in STREAM:
        split = split_recording(sets[part], "labelled-out")
        start = time.perf_counter()
        views = FrameStore(sets[part], config).views(split.train[::every])
        for view in tqdm(views, part, total=len(split.train[::every]), unit="frame"):
            learner.learn(view)
        stage: dict[str, Any] = {"after": part, "learn_s": round(time.perf_counter() - start, 1)}
        stage |= {"remembered": len(learner.memory), "memory_mb": round(learner.memory.nbytes / 2**20, 1)}
        for name, recording in sets.items():
            result = held_back(learner, recording, split_recording(recording, "labelled-out").test)
            stage[name] = [result.auc, result.auc_within_depression]
        stages.append(stage)
        print("after", part, {key: value for key, value in stage.items() if key != "after"}, flush=True)
    return stages


def held_back(learner: OnlineLearner, recording: Recording, test: Sequence[int]) -> RocResult:
    """The entropy on frames that are never learned from."""
    accumulator = MethodAccumulator()
    frames: Iterable[Any] = FrameStore(recording, learner.config).frames(test)
    for frame, view in frames:
        accumulator.add_scores({"entropy": learner.predict(view).entropy}, scored_pixels(frame))
    return accumulator.rocs["entropy"].compute()


if __name__ == "__main__":
    main()

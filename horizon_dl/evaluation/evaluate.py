"""One trained net against the truth of a recording."""

from tqdm import tqdm

from horizon_dl.errors import InputError
from horizon_dl.evaluation.compare import Comparison, OnFrame, score_frames
from horizon_dl.evaluation.learners import Method, NetMethod
from horizon_dl.evaluation.metrics import SCHEMA, method_metrics
from horizon_dl.evaluation.training_free import training_free_methods
from horizon_dl.frames.frame import Recording
from horizon_dl.learning.run import Run
from horizon_dl.learning.store import FrameStore


def evaluate(
    run: Run, recording: Recording, *, on_frame: OnFrame | None = None, progress: bool = False
) -> Comparison:
    """Score a trained net, beside the training-free baselines, on every labelled frame of a recording.

    Whether those frames were trained on is the caller's affair; `metrics["trained_on"]` names the data.

    Raises:
        InputError: there is no truth, or too many frames cannot be used.
    """
    store = FrameStore(recording, run.config)
    labelled = [index for index, entry in enumerate(recording.entries) if entry.truth_path]
    if not labelled:
        raise InputError(
            recording.name, "has no truth (labels/*.png)", "use `horizon-dl predict` for pictures"
        )
    methods: dict[str, Method] = {"cnn": NetMethod(run.net)}
    methods |= training_free_methods()
    frames = tqdm(store.frames(labelled), "evaluate", total=len(labelled), unit="frame", disable=not progress)
    found = score_frames(methods, {"cnn": run.threshold}, frames, run.config.labels.band_rad, on_frame)
    found["cnn"].train_s = float(run.info.get("train_s", 0.0))
    tallies = {name: [tally] for name, tally in found.items()}
    metrics = {
        "schema": SCHEMA,
        "data": recording.name,
        "protocol": "evaluate",
        "seeds": [run.config.seed],
        "frames": {
            "train": run.info.get("frames", 0),
            "test": len(labelled),
            "skipped": len(store.skipped),
        },
        "trained_on": run.info.get("data"),
        "methods": {name: method_metrics(one, run.info["threshold_rule"]) for name, one in tallies.items()},
    }
    return Comparison(metrics, tallies, store.skipped)

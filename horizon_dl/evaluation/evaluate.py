"""One trained net against the truth of a recording."""

from collections.abc import Iterator, Mapping, Sequence

from horizon_dl.data.source import Recording
from horizon_dl.errors import InputError
from horizon_dl.evaluation.compare import Comparison
from horizon_dl.evaluation.scoring import (
    OnFrame,
    Reading,
    accumulate,
    read_frame,
    read_frames,
    watching,
)
from horizon_dl.methods.learners import Method, NetMethod
from horizon_dl.methods.names import NET
from horizon_dl.methods.onnx_file import FileMethod, FileRun
from horizon_dl.methods.training_free import training_free_methods
from horizon_dl.metrics.metrics import metrics_file
from horizon_dl.metrics.ranging_block import RangingBlock
from horizon_dl.progress import show_progress
from horizon_dl.ranging.vehicle_height import VehicleHeight
from horizon_dl.runtime.predict import check_camera
from horizon_dl.training.frame_store import FrameStore
from horizon_dl.training.run_folder import Run
from horizon_dl.workers import SERIAL, Workers


def evaluate(
    run: Run | FileRun,
    recording: Recording,
    *,
    on_frame: OnFrame | None = None,
    progress: bool = False,
    workers: Workers = SERIAL,
    vehicle: VehicleHeight | None = None,
) -> Comparison:
    """Score a run folder or a model file, beside the training-free baselines, on every labelled frame.

    Whether those frames were trained on is the caller's affair; `metrics["trained_on"]` names the data. With
    a `vehicle` distances are also counted of what is in its way.

    Raises:
        InputError: there is no truth, too many frames cannot be used, or the file is for another camera.
    """
    store = FrameStore(recording, run.config)
    labelled = [index for index, entry in enumerate(recording.headers) if entry.labelled]
    if not labelled:
        raise InputError(
            recording.name, "has no truth (labels/*.png)", "use `horizon-dl predict` for pictures"
        )
    learner = run.learner if isinstance(run, FileRun) else NET
    methods: dict[str, Method] = {
        learner: _learner(run, recording),
        **training_free_methods(run.config.geodesic),
    }
    readings = _readings(methods, store, labelled, workers)
    bar = show_progress(readings, "evaluate", total=len(labelled), unit="frame", disable=not progress)
    ranging = RangingBlock(recording.headers, run.config.ranging_params, vehicle)
    watch = watching(ranging, on_frame, learner)
    thresholds, band_rad = {learner: run.threshold}, run.config.labels.band_rad
    found = accumulate(bar, thresholds, band_rad, watch, {learner: run.place})
    found[learner].train_s = float(run.info.get("train_s", 0.0))
    if isinstance(run, Run):
        found[learner].simulated_threshold = run.info.get("simulated_threshold")
    accumulators = {name: [accumulator] for name, accumulator in found.items()}
    rule, seeds = run.info["threshold_rule"], [run.config.seed]
    frames = {"train": run.info.get("frames", 0), "test": len(labelled), "skipped": len(store.skipped)}
    metrics = metrics_file(recording.name, "evaluate", seeds, frames, accumulators, rule, ranging)
    metrics["trained_on"] = run.info.get("data")
    return Comparison(metrics, accumulators, store.skipped)


def _readings(
    methods: Mapping[str, Method], store: FrameStore, indices: Sequence[int], workers: Workers
) -> Iterator[Reading]:
    # A runtime's session stays in its process.
    if any(isinstance(method, FileMethod) for method in methods.values()):
        return (read_frame(methods, frame, view) for frame, view in store.frames(indices))
    return read_frames(methods, store, indices, workers)


def _learner(run: Run | FileRun, recording: Recording) -> Method:
    if isinstance(run, FileRun):
        check_camera(run.model, recording.calibrated, recording.name)
        return FileMethod(run.model, run.config.geodesic, run.info["path_agreement"])
    return NetMethod(run.net, run.config.geodesic, run.info.get("path_agreement"))

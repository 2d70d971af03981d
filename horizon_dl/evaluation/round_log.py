"""What a training has come to after each of its rounds, for its logger: figures, and pictures."""

from lightning.pytorch.loggers import Logger

from horizon_dl.data.evenly import evenly
from horizon_dl.geometry.horizon import labelled_pixels
from horizon_dl.metrics.method_accumulator import MethodAccumulator
from horizon_dl.metrics.scored_pixels import scored_pixels
from horizon_dl.models.fcn import HorizonFCN
from horizon_dl.runtime.prediction import FLOWN_SCORE, Prediction
from horizon_dl.training.frame_store import FrameStore
from horizon_dl.training.loggers import log_picture
from horizon_dl.training.predict import measured, prediction_of
from horizon_dl.uncertainty.measures import binary_entropy
from horizon_dl.uncertainty.threshold import paper_threshold
from horizon_dl.visualization.file_sinks import panel

FRAMES, PICTURES = 8, 3


def log_round(net: HorizonFCN, store: FrameStore, step: int, logger: Logger) -> None:
    """Horizon accuracy, AUC where there is a truth, and pictures of a few frames that were trained on.

    Args:
        net: as it is after the round.
        store: of the training frames; at most 8 are looked at, and 3 drawn.
        step: steps taken in all rounds so far.
        logger: of `open_logger`.
    """
    config, labelled = store.config, [i for i, one in enumerate(store.recording.headers) if one.labelled]
    chosen = evenly(labelled or range(store.recording.length), FRAMES)
    looked_at = [(frame, view, measured(net, view)) for frame, view in store.frames(chosen)]
    threshold = paper_threshold(
        (
            (binary_entropy(found.p_above), labelled_pixels(view.elevation, config.labels.band_rad))
            for _, view, found in looked_at
        ),
        config.threshold.percentile,
    )
    figures = MethodAccumulator()
    for number, (frame, view, found) in enumerate(looked_at):
        figures.add_sides(view, found.p_above, config.labels.band_rad)
        prediction: Prediction = prediction_of(frame, view, found, threshold)
        if frame.truth is not None:
            figures.add_scores({FLOWN_SCORE: prediction.flown_score}, scored_pixels(frame))
        if number < PICTURES:
            log_picture(logger, f"frames/{frame.name}", panel(frame, prediction, None), step)
    values = {"horizon_accuracy": figures.right_sides / max(figures.sides, 1)}
    roc = figures.rocs[FLOWN_SCORE].compute() if FLOWN_SCORE in figures.rocs else None
    if roc is not None and roc.auc is not None and roc.auc_within_depression is not None:
        values |= {"auc": roc.auc, "auc_within_depression": roc.auc_within_depression}
    logger.log_metrics(values, step)

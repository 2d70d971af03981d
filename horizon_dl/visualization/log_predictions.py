"""Every frame of a source through a predictor, and what was found into a sink."""

from collections.abc import Callable, Iterable

from horizon_dl.data.frame import Frame
from horizon_dl.errors import FrameError
from horizon_dl.ranging.vehicle_height import VehicleHeight
from horizon_dl.runtime.prediction import Predictor
from horizon_dl.runtime.ranged import ranges_of
from horizon_dl.visualization.sink import Sink


def log_predictions(
    predictor: Predictor,
    frames: Iterable[Frame | FrameError],
    sink: Sink,
    stopped: Callable[[], bool] = lambda: False,
    height: VehicleHeight | None = None,
) -> tuple[int, dict[str, str]]:
    """Predict frame by frame.

    Args:
        predictor: see `open_predictor`.
        frames: of a source that the predictor has checked.
        sink: takes what was found.
        stopped: ends the run before the frames do.
        height: of the vehicle; obstacles that do not reach up to it are left out.

    Returns:
        How many frames were predicted, and why the others were not.
    """
    count, skipped = 0, {}
    for item in frames:
        try:
            if isinstance(item, FrameError):
                raise item
            prediction = predictor.predict(item)
        except FrameError as error:
            skipped[str(error)] = str(error)
            continue
        sink.log(item, prediction, ranges_of(item, prediction, height))
        count += 1
        if stopped():
            break
    return count, skipped

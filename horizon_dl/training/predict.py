"""A trained net on new images, with or without attitude."""

from dataclasses import replace
from pathlib import Path

from horizon_dl.config import Config
from horizon_dl.data.frame import Frame, checked
from horizon_dl.data.source import FrameSource
from horizon_dl.data.view import View, any_view
from horizon_dl.evidence.self_assessment import said
from horizon_dl.geometry.rays import camera_rays
from horizon_dl.models.encoded import EncodedImage
from horizon_dl.models.fcn import HorizonFCN
from horizon_dl.runtime.prediction import Prediction
from horizon_dl.runtime.rules import FlightRules
from horizon_dl.training.evidence import place_of
from horizon_dl.training.run_folder import Run, load_run
from horizon_dl.uncertainty.measures import Measures


class RunPredictor:
    """A run folder as a `Predictor`; it takes frames of every camera and size."""

    def __init__(self, run: Run, name: str = "run") -> None:
        self.run, self.name = run, name
        data = run.info.get("data")
        self.trained_on = str(data) if data else None
        self.doubt = said(run.info.get("self_assessment"))

    def check(self, source: FrameSource) -> None:
        """Every source fits."""

    def note(self) -> None:
        """Nothing to note: a run's net works at every size."""

    def predict(self, frame: Frame) -> Prediction:
        """See `Predictor`; FrameError for an image of another size than its camera's."""
        place = place_of(self.run.info, self.name)
        return replace(predict(self.run, checked(frame)), place=place, rules=flight_rules(self.run.config))


def flight_rules(config: Config) -> FlightRules:
    """The rules of a config, as a model that is exported with it is flown by."""
    return FlightRules(config.ranging_params, config.evidence, config.flight)


def load_run_predictor(folder: Path) -> RunPredictor:
    """The predictor in a run folder; errors as of `load_run`."""
    return RunPredictor(load_run(folder), folder.name)


def predict(run: Run, frame: Frame) -> Prediction:
    """Measures and obstacle map of one frame, with or without attitude."""
    view = any_view(frame, run.config.image.max_pixels)
    return prediction_of(frame, view, measured(run.net, view), run.threshold)


def measured(net: HorizonFCN, view: View) -> Measures:
    """All a net says of a view, (h, w) each."""
    return EncodedImage(net, view.image).measures(view.elevation > 0)


def prediction_of(frame: Frame, view: View, found: Measures, threshold: float) -> Prediction:
    """A learner's measures of a view as a prediction, with the rays of the frame's camera if it is known."""
    directions = None
    if frame.camera is not None:
        directions = camera_rays(frame.camera.scaled(view.image.shape[1], view.image.shape[0])).directions
    return Prediction.of(view, found, threshold, directions)

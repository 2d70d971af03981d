"""An exported model in the place of the run folder it came from."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, TypeAdapter, ValidationError

from horizon_dl.config import Config
from horizon_dl.data.frame import Frame
from horizon_dl.data.view import View
from horizon_dl.errors import InputError
from horizon_dl.evidence.place import Place
from horizon_dl.methods.names import NET
from horizon_dl.methods.scores import score_maps
from horizon_dl.runtime.model import ObstacleModel
from horizon_dl.runtime.predict import measures_of
from horizon_dl.targets.geodesic_params import GEODESIC, GeodesicParams

AGREEMENT = TypeAdapter[float | None](
    Annotated[float, Field(ge=-1.0, le=1.0, allow_inf_nan=False, strict=True)] | None
)


@dataclass(frozen=True)
class FileMethod:
    """A model file as a method of the evaluation; it has no single pass; see `fused_score`."""

    model: ObstacleModel
    paths: GeodesicParams = GEODESIC
    agreement: float | None = None

    def score_maps(self, frame: Frame, view: View) -> dict[str, NDArray[np.float32]]:
        """All scores; the file resizes the frame's image itself."""
        found = self.model.predict(frame.image, frame.up_cam)
        return score_maps(view, measures_of(found), paths=self.paths, agreement=self.agreement)


@dataclass(frozen=True)
class FileRun:
    """What the evaluation asks of a run folder, from a model file."""

    model: ObstacleModel
    config: Config
    info: dict[str, Any]

    @property
    def learner(self) -> str:
        """`cnn` or `rf`, as in `metrics.json`."""
        return str(self.model.card.get("learner", NET))

    @property
    def threshold(self) -> float:
        """Entropy above which a pixel counts as obstacle, bits."""
        return self.model.threshold

    @property
    def place(self) -> Place | None:
        """Limits for its evidence."""
        return self.model.place


def load_file_run(path: Path) -> FileRun:
    """Load a model file for evaluation.

    Raises:
        InputError: it is damaged or no such file, or made by a version with another configuration.
    """
    model = ObstacleModel.load(path)
    try:
        config = Config.model_validate(model.card["config"])
        info = {
            **model.card["trained_on"],
            "threshold_rule": model.card["threshold"]["rule"],
            "path_agreement": AGREEMENT.validate_python(model.card.get("path_agreement")),
        }
    except (ValidationError, KeyError, TypeError):
        raise InputError(path, "was exported by another version", "export it again") from None
    return FileRun(model, config, info)

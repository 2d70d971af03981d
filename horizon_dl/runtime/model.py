"""The exported model at work: numpy and onnxruntime alone."""

import json
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np
import onnxruntime
from numpy.typing import ArrayLike, NDArray

from horizon_dl.errors import InputError, shortened
from horizon_dl.geometry.camera import Camera
from horizon_dl.runtime.acceptance import checked_place, checked_size, checked_threshold, smoke_test
from horizon_dl.runtime.checksum import read_checksummed
from horizon_dl.runtime.rules import FlightRules
from horizon_dl.runtime.signature import Verifier

INPUTS = ("image", "up_cam")
CARD_KEY = "card"

Map = NDArray[np.float32]


@dataclass(frozen=True)
class Outputs:
    """What the model says of one frame; (h, w) is the working size, (H, W) the camera's.

    Attributes:
        p_above: (h, w) in [0, 1], mean over the dropout samples.
        entropy: (h, w) bits in [0, 1], the obstacle score.
        expected_entropy: (h, w) bits in [0, 1].
        mutual_information: (h, w) bits in [0, 1].
        surprisal: (h, w) bits in [0, 126]; means nothing without attitude.
        elevation: (h, w) rad over the horizon, NaN without attitude and where the lens model gives no ray.
        obstacles: (H, W) bool, entropy over the threshold, lone pixels removed.
    """

    p_above: Map
    entropy: Map
    expected_entropy: Map
    mutual_information: Map
    surprisal: Map
    elevation: Map
    obstacles: NDArray[np.bool_]


OUTPUTS = tuple(part.name for part in fields(Outputs))
"""In the order of the file."""


class ObstacleModel:
    """A model file, loaded.

    Attributes:
        card: what the file says of itself; its keys are described in `exports/README.md`.
        camera: of the upright images it takes.
        place: what its training pictures were like; None in files of before that was kept.
        size: (w, h), the working size.
        threshold: entropy above which a pixel is an obstacle, bits.
        rules: of ranging, evidence and watchdog, as it was exported with.
        sha256: the file's hash, as in its seal.

    Example:
        >>> model = ObstacleModel.load("model.onnx")              # doctest: +SKIP
        >>> found = model.predict(image, up_cam=[0, -1, 0])       # doctest: +SKIP
        >>> found.obstacles.any()                                 # doctest: +SKIP
    """

    def __init__(self, session: onnxruntime.InferenceSession, card: dict[str, Any], sha256: str) -> None:
        self._session = session
        self.card = card
        self.sha256 = sha256
        self.camera = camera_from_card(card)
        self.place = checked_place(card)
        self.size = checked_size(card)
        self.threshold = checked_threshold(card)
        self.rules = FlightRules.of_card(card)

    @classmethod
    def load(cls, path: str | Path, threads: int = 1, trusted: Verifier | None = None) -> "ObstacleModel":
        """Check a file's seal, make it ready and try it on made-up pictures.

        Nothing in it is executed but its ONNX operators.

        Args:
            path: of the file.
            threads: within an operator.
            trusted: whose signature the file has to bear; see `read_verifier`.

        Raises:
            InputError: no such file, another kind of file, cut off, altered, or without its card.
        """
        path = Path(path)
        content, sha256 = read_checksummed(path, trusted)
        try:
            session = new_session(content, threads)
            card = json.loads(session.get_modelmeta().custom_metadata_map[CARD_KEY])
            model = cls(session, card, sha256)
        except Exception as error:  # onnxruntime has a dozen exceptions of its own
            said = next(iter(str(error).splitlines()), type(error).__name__)
            problem = f"cannot be loaded ({shortened(said, 200)})"
            raise InputError(path, problem, "export it again with `horizon-dl export`") from None
        names = (
            tuple(one.name for one in session.get_inputs()),
            tuple(one.name for one in session.get_outputs()),
        )
        if names != (INPUTS, OUTPUTS):
            raise InputError(path, "has other inputs or outputs than expected", "export it again")
        try:
            wrong = smoke_test(model)
        except Exception as error:  # onnxruntime again, or a card of another size than the graph
            said = next(iter(str(error).splitlines()), type(error).__name__)
            wrong = f"cannot be run ({shortened(said, 200)})"
        if wrong is not None:
            raise InputError(path, wrong, "train longer, or export it again")
        return model

    def predict(self, image: NDArray[np.uint8], up_cam: ArrayLike | None = None) -> Outputs:
        """Maps of one frame.

        Args:
            image: (H, W, 3) uint8 RGB, upright, of the camera's size.
            up_cam: (3,) the world's up as a unit vector in the optical frame, or None where it is not known.

        Raises:
            ValueError: another shape or type, or no unit vector.
        """
        feed = {"image": self._checked(image), "up_cam": unit_or_nan(up_cam)}
        maps = dict(zip(OUTPUTS, self._session.run(OUTPUTS, feed), strict=True))
        return Outputs(**{**maps, "obstacles": maps["obstacles"].astype(np.bool_)})

    def _checked(self, image: NDArray[np.uint8]) -> NDArray[np.uint8]:
        expected = (self.camera.height, self.camera.width, 3)
        if image.shape != expected or image.dtype != np.uint8:
            raise ValueError(f"the image is {image.dtype} {image.shape}; the model takes uint8 {expected}")
        return np.ascontiguousarray(image)[None]


def new_session(content: bytes, threads: int, **options: Any) -> onnxruntime.InferenceSession:
    """A session on the CPU whose waiting threads sleep: on a drone the other processes need the cores.

    Args:
        content: bytes of the model.
        threads: within an operator.
        options: further fields of `onnxruntime.SessionOptions`.
    """
    settings = onnxruntime.SessionOptions()
    settings.intra_op_num_threads = threads
    settings.inter_op_num_threads = 1
    settings.log_severity_level = 3
    settings.add_session_config_entry("session.intra_op.allow_spinning", "0")
    for name, value in options.items():
        setattr(settings, name, value)
    return onnxruntime.InferenceSession(content, settings, providers=["CPUExecutionProvider"])


def camera_from_card(card: dict[str, Any]) -> Camera:
    """The camera that a card, or a run folder's `run.json`, holds."""
    fields = dict(card["camera"])
    fields["distortion"] = tuple(fields["distortion"])
    return Camera(**fields)


def unit_or_nan(up_cam: ArrayLike | None) -> Map:
    """(3,) float32; NaN for None. ValueError if it is no unit vector to 1 %."""
    if up_cam is None:
        return np.full(3, np.nan, np.float32)
    up = np.asarray(up_cam, np.float32)
    if up.shape != (3,) or not abs(float(np.linalg.norm(up)) - 1) < 0.01:
        raise ValueError(f"up_cam {up.tolist()} is no unit vector of three")
    return up

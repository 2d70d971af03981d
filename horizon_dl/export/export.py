"""Exporting a run folder: the file, its card and its parity figures."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import onnx

from horizon_dl.data.evenly import evenly
from horizon_dl.data.frame import Frame
from horizon_dl.data.source import Recording
from horizon_dl.errors import FrameError, InputError
from horizon_dl.export.card import make_card
from horizon_dl.export.graph import Pipeline
from horizon_dl.export.onnx_file import file_bytes, graph_of
from horizon_dl.export.parity import Learner, parity, sample_frames
from horizon_dl.geometry.camera import Camera
from horizon_dl.output import write_json
from horizon_dl.runtime.model import camera_from_card
from horizon_dl.runtime.signature import Signer
from horizon_dl.training.run_folder import Run

MOST_FRAMES = 8


@dataclass(frozen=True)
class Exported:
    """One exported model.

    Attributes:
        graph: without card and seal.
        card: with its parity figures.
        sign: gives its signature; None: it bears none.
    """

    graph: onnx.ModelProto
    card: dict[str, Any]
    sign: Signer | None = None

    def with_card(self, **entries: Any) -> "Exported":
        """The same model with more in its card."""
        return replace(self, card={**self.card, **entries})

    def signed(self, sign: Signer | None) -> "Exported":
        """The same model, signed."""
        return replace(self, sign=sign)

    def content(self) -> bytes:
        """The checksummed file."""
        return file_bytes(self.graph, self.card, self.sign)

    def write(self, folder: Path, name: str = "model") -> Path:
        """Write `NAME.onnx`, and `card.json` and `parity.json` (with NAME in front unless it is `model`)."""
        prefix = "" if name == "model" else f"{name}."
        path = folder / f"{name}.onnx"
        path.write_bytes(self.content())
        write_json(folder / f"{prefix}card.json", self.card)
        write_json(folder / f"{prefix}parity.json", self.card["parity"])
        return path


def export_run(run: Run, camera: Camera, frames: Sequence[Frame] = ()) -> Exported:
    """The pipeline of a run as an ONNX graph for one camera, compared with the run itself.

    Args:
        run: trained.
        camera: of the upright images that the file will take.
        frames: of that camera and with attitude, to compare on; without any, made-up ones.

    Raises:
        RuntimeError: the file does not say what the run says.
    """
    return exported(run.net, run.config.image.max_pixels, run.threshold, make_card(run, camera), frames)


def exported(
    learner: Learner, max_pixels: int, threshold: float, card: dict[str, Any], frames: Sequence[Frame] = ()
) -> Exported:
    """The pipeline of any learner for its card's camera, compared with the learner; see `export_run`."""
    camera = camera_from_card(card)
    found = Exported(graph_of(Pipeline(learner, camera, max_pixels, threshold)), card)
    figures = parity(learner, max_pixels, threshold, found.content(), frames or sample_frames(camera))
    if not figures["good"]:
        raise RuntimeError(f"the exported file differs from what was exported: {figures['levels']}")
    return found.with_card(parity={**figures, "on": "real frames" if frames else "made-up frames"})


def trained_camera(run: Run, where: str | Path) -> Camera:
    """The camera of the training data; InputError where the run folder holds none."""
    if "camera" not in run.info:
        raise InputError(where, "holds no camera", "name a data set with --camera")
    try:
        return camera_from_card(run.info)
    except (KeyError, TypeError, ValueError):
        raise InputError(where, "holds a camera that is none", "name a data set with --camera") from None


def parity_frames(recording: Recording) -> list[Frame]:
    """At most 8 frames with attitude, evenly spread; those that cannot be read are left out."""
    usable = [index for index, entry in enumerate(recording.headers) if entry.up_cam is not None]
    frames = []
    for index in evenly(usable, MOST_FRAMES):
        try:
            frames.append(recording.read(index))
        except FrameError:
            continue
    return frames

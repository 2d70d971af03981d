"""Export a net and run the file as a robot would: the last step of the demo."""

from dataclasses import dataclass
from pathlib import Path

from horizon_dl.data.source import Recording
from horizon_dl.export.export import export_run, parity_frames
from horizon_dl.runtime.benchmark import quartiles, timed_in_turn
from horizon_dl.runtime.model import ObstacleModel
from horizon_dl.training.run_folder import Run

RUNS = 20


@dataclass(frozen=True)
class Tried:
    """What became of an export.

    Attributes:
        path: of the model file.
        difference: largest of `p_above`, from the net's own, at any optimisation level.
        median_ms: of a run on one thread.
    """

    path: Path
    difference: float
    median_ms: float

    def lines(self) -> list[str]:
        """The same in words."""
        size = self.path.stat().st_size / 1e6
        return [
            f"exported to {self.path.name} ({size:.1f} MB); it differs from the net by {self.difference:.0e}",
            f"run without torch: {self.median_ms:.1f} ms a frame on one thread",
        ]


def export_and_try(run: Run, recording: Recording, folder: Path) -> Tried:
    """Write `model.onnx` with its card, load it and run it on a frame of the recording.

    Raises:
        RuntimeError: the file does not say what the run says.
    """
    frames = parity_frames(recording)[-2:]
    exported = export_run(run, recording.calibrated, frames)
    path = exported.write(folder)
    model, frame = ObstacleModel.load(path), frames[-1]
    times = timed_in_turn({"run": lambda: model.predict(frame.image, frame.up_cam)}, RUNS)["run"]
    difference = max(level["p_above"] for level in exported.card["parity"]["levels"].values())
    return Tried(path, difference, quartiles(times)["median_ms"])

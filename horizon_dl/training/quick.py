"""A net of a minute, to hear what it says of itself before anybody trains a good one."""

from typing import Any

from horizon_dl.config import Config
from horizon_dl.data.evenly import evenly
from horizon_dl.data.source import Recording
from horizon_dl.training.train import train_run

FRAMES, ROUNDS = 100, (100, 100)


def quick_assessment(recording: Recording, config: Config, *, progress: bool = False) -> dict[str, Any]:
    """What a quickly trained net says of itself, see `SelfAssessment.compute`.

    Args:
        recording: at most 100 of its frames are learned from, evenly spread.
        config: its rounds are replaced by two of 100 steps.
        progress: show progress bars.

    Raises:
        InputError: no frame can be used.
    """
    quick = config.model_copy(update={"train": config.train.model_copy(update={"rounds": ROUNDS})})
    frames = recording.select(evenly(range(recording.length), FRAMES))
    assessment: dict[str, Any] = train_run(frames, quick, progress=progress).info["self_assessment"]
    return assessment

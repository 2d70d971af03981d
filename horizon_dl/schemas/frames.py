"""A line of `frames.jsonl`, which `online` writes for every frame."""

from typing import ClassVar

from pydantic import Field

from horizon_dl.schemas.base import Versioned


class FrameLine(Versioned):
    """What became of one frame; null where nothing is known."""

    FILE: ClassVar[str] = "frames.jsonl"

    schema_: int = Field(default=1, alias="schema")
    index: int
    name: str
    time_s: float | None
    learned: bool
    not_learned: str | None
    loss: float | None
    horizon_accuracy: float | None
    calibration_error: float | None
    auc: float | None
    auc_within_depression: float | None
    predict_ms: float
    learn_ms: float
    frames_per_s: float | None

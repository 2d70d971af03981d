"""`metrics.json` of `compare`, `evaluate` and `online`."""

from typing import ClassVar

from pydantic import Field

from horizon_dl.schemas.base import Part, Versioned

Figure = float | None


class ScoreFigures(Part):
    """Figures of one score, obstacle against floor below the horizon; `_sd` is the spread over the seeds."""

    auc: Figure
    auc_within_depression: Figure
    ap: Figure
    fpr90: Figure = None
    fpr95: Figure
    best_f1: Figure


class OperatingPoint(Part):
    """A threshold in bits, and the rates there; the paper's also `_filtered`, after the neighbour filter."""

    threshold: Figure
    tpr: Figure
    fpr: Figure
    rule: str


class OtherPixels(Part):
    """Figures over other pixels: `above`, `crossing` or `low`."""

    obstacles: int
    others: int
    scores: dict[str, ScoreFigures]


class MethodMetrics(Part):
    """One method."""

    scores: dict[str, ScoreFigures]
    train_s: float
    predict_ms_per_frame: float
    horizon_accuracy: Figure = None
    operating_point: OperatingPoint | None = None
    operating_point_simulated: OperatingPoint | None = None
    above: OtherPixels | None = None
    crossing: OtherPixels | None = None
    low: OtherPixels | None = None


class Ranging(Part):
    """Free distances against measured ones; shares of the bearings with a true distance."""

    median_relative_error: Figure
    columns: int
    missed: Figure = None
    false_stop: Figure = None
    unknown: Figure = None
    within_2sd: Figure = None
    within_2sd_seen: Figure = None
    contact_seen: Figure = None


class Metrics(Versioned):
    """The whole file."""

    FILE: ClassVar[str] = "metrics.json"

    schema_: int = Field(alias="schema")
    data: str
    protocol: str
    seeds: list[int]
    frames: dict[str, int | None]
    methods: dict[str, MethodMetrics]
    ranging: Ranging

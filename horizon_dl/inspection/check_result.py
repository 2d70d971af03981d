"""What a check of data found, as figures and words."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, replace
from typing import Any

from horizon_dl.data.frame import FrameHeader
from horizon_dl.data.view import View
from horizon_dl.inspection.finding import Finding, Level
from horizon_dl.inspection.image_quality import Exposure, TruthStatistics
from horizon_dl.inspection.orientation import Orientation
from horizon_dl.inspection.time_offset import MotionFit
from horizon_dl.inspection.timing_and_attitude import Attitudes, Labels, Percentiles, Timing
from horizon_dl.logs.clock.clock_fit import ClockFit


@dataclass(frozen=True)
class DataCheck:
    """What was found about a recording; figures are None where nothing is known.

    Attributes:
        frames: entries of the recording.
        sampled: images that were looked at, of which `unreadable` could not be read.
        unreadable_examples: name and reason of the first few.
        findings: the words, the verdict's reasons among them.
        verdict: one sentence; `level` is its level.
        clock: of the pictures against the log's, where there is a log.
        self_assessment: of a quickly trained net, see `SelfAssessment.compute`, where one was trained.
        overlay_views: evenly spaced frames to draw the horizon on; not part of the JSON.
    """

    name: str
    format: str
    frames: int
    sampled: int
    unreadable: int
    unreadable_examples: tuple[tuple[str, str], ...]
    band_deg: float
    notes: tuple[str, ...]
    timing: Timing
    attitudes: Attitudes | None
    labels: Labels | None
    exposure: Exposure | None
    motion: MotionFit | None
    height_m: Percentiles | None
    truth: TruthStatistics | None
    orientation: Orientation | None = None
    findings: tuple[Finding, ...] = ()
    level: Level = "ok"
    verdict: str = ""
    clock: ClockFit | None = None
    self_assessment: Mapping[str, Any] | None = None
    overlay_views: tuple[tuple[FrameHeader, View], ...] = field(default=(), repr=False)

    def to_json(self) -> dict[str, Any]:
        """Everything but the pictures, as what `json.dumps` takes."""
        return asdict(replace(self, overlay_views=()), dict_factory=_for_json)


KEYS = {"hint": "way_out"}
"""A finding's hint has had this key in `check.json` from the beginning; keys are not renamed."""


def _for_json(items: list[tuple[str, Any]]) -> dict[str, Any]:
    return {KEYS.get(name, name): value for name, value in items if name != "overlay_views"}

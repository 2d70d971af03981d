"""`check.json` of `check-data`."""

from typing import Any, ClassVar

from pydantic import Field

from horizon_dl.inspection.finding import Level
from horizon_dl.inspection.timing_and_attitude import Timing
from horizon_dl.schemas.base import Part, Versioned


class FindingFields(Part):
    """One thing that was found; `way_out` says what to do about it."""

    level: Level
    text: str
    way_out: str
    reason: str


class Check(Versioned):
    """The whole file; figures are null where nothing is known, `self_assessment` without `--quick-train`."""

    FILE: ClassVar[str] = "check.json"

    schema_: int = Field(default=1, alias="schema")
    name: str
    format: str
    frames: int
    sampled: int
    unreadable: int
    timing: Timing
    attitudes: dict[str, Any] | None
    labels: dict[str, Any] | None
    findings: tuple[FindingFields, ...]
    level: Level
    verdict: str
    self_assessment: dict[str, Any] | None = None

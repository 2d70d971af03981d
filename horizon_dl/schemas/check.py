"""`check.json` of `check-data`."""

from typing import Any, ClassVar

from pydantic import Field

from horizon_dl.inspection.finding import Finding, Level
from horizon_dl.inspection.timing_and_attitude import Timing
from horizon_dl.schemas.base import Versioned


class Check(Versioned):
    """The whole file; figures are null where nothing is known."""

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
    findings: tuple[Finding, ...]
    level: Level
    verdict: str

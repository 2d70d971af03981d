"""Findings about data: a level, a plain sentence, and a hint."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

Level = Literal["ok", "warning", "problem"]


@dataclass(frozen=True)
class Finding:
    """One thing that was found.

    Attributes:
        level: `ok`, `warning` or `problem` (learning cannot work).
        text: one plain sentence.
        hint: what to do about it; empty where nothing has to be done.
        reason: the finding as a clause after "because", given iff it decides the verdict.
    """

    level: Level
    text: str
    hint: str = ""
    reason: str = ""


def verdict_of(findings: Sequence[Finding]) -> tuple[Level, str]:
    """The overall level and sentence: can work, will probably work poorly because, cannot work because.

    Example:
        >>> verdict_of([Finding("problem", "No image can be read.", reason="no image can be read")])
        ('problem', 'This data cannot work because no image can be read.')
    """
    problems = [finding.reason for finding in findings if finding.level == "problem"]
    if problems:
        return "problem", f"This data cannot work because {_joined(problems)}."
    doubts = [finding.reason for finding in findings if finding.level == "warning" and finding.reason]
    if doubts:
        return "warning", f"This data will probably work poorly because {_joined(doubts)}."
    warnings = sum(finding.level == "warning" for finding in findings)
    if not warnings:
        return "ok", "This data can work."
    return "ok", f"This data can work; mind the {'warning' if warnings == 1 else f'{warnings} warnings'}."


def _joined(reasons: Sequence[str]) -> str:
    if len(reasons) == 1:
        return reasons[0]
    return ", ".join(reasons[:-1]) + " and " + reasons[-1]

"""A number that knows without labels what a net is worth: how much below the horizon it takes for floor.

Where nearly everything below the horizon is lower than the camera (desks, beds), the net never sees it
above, and is sure of it as of a floor: the share of pixels below the horizon that it calls "below" nears one,
and its AUC falls. The head with the smallest field of view is asked: one that sees more tells the foot of a
wall from its top by its place, and the better it is trained, the surer, everywhere. Over eight sets, three
seeds each, the share's rank correlation with the AUC within depression bands is -.67 (docs/RESEARCH.md).
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

DOUBTFUL, NOT_TO_BE_TRUSTED = 0.9, 0.97
"""Picked on seven sets, with nets that started at random. With the start of today, share (AUC within): arena
.69 (.98), hallway .84 (.90), embedded .86 (.97); room .92 (.79), KITTI .94 (.90), corridor .95 (.96);
icl_office_kt3 .985 (.19), tum_fr1_rpy 1.0 (.80): of the corridor it warns without need."""
WORDS = {
    "ok": "",
    "doubtful": "much below the horizon is as sure as floor: low obstacles and shade may be missed",
    "not to be trusted": "nearly all below the horizon is as sure as floor: obstacles are told poorly",
}


class SelfAssessment:
    """Share of the pixels below the horizon that a net calls below, over unlabelled training frames.

    Example:
        >>> assessment = SelfAssessment()
        >>> assessment.update(np.array([[0.9, 0.4, 0.1, 0.2]]), np.array([[0.1, -0.1, -0.2, -0.3]]))
        >>> assessment.compute()["sure_below"], assessment.compute()["verdict"]
        (1.0, 'not to be trusted')
    """

    def __init__(self) -> None:
        self._below = self._called_below = 0

    def update(self, p_above: NDArray[np.floating], elevation: NDArray[np.floating]) -> None:
        """Count a frame: (h, w) in [0, 1], and (h, w) rad over the horizon, NaN where not known."""
        below = elevation < 0.0
        self._below += int(below.sum())
        self._called_below += int((p_above[below] < 0.5).sum())

    def merge(self, other: "SelfAssessment") -> None:
        """Add everything that another one has counted."""
        self._below += other._below
        self._called_below += other._called_below

    def state(self) -> dict[str, NDArray[Any]]:
        """All that was counted, as arrays by name."""
        return {"counts": np.array([self._below, self._called_below], np.int64)}

    def load(self, state: dict[str, NDArray[Any]]) -> None:
        """Take a state in place of what was counted."""
        self._below, self._called_below = state["counts"].tolist()

    def compute(self) -> dict[str, Any]:
        """`sure_below`, the share (None before any pixel), and `verdict`: ok, doubtful, not to be trusted."""
        share = self._called_below / self._below if self._below else None
        return {"sure_below": share, "verdict": verdict(share)}


def verdict(share: float | None) -> str:
    """The share in words.

    Example:
        >>> verdict(0.7), verdict(0.95)
        ('ok', 'doubtful')
    """
    if share is None or share > NOT_TO_BE_TRUSTED:
        return "not to be trusted"
    return "doubtful" if share > DOUBTFUL else "ok"


def said(assessment: object) -> str | None:
    """A line for the user of what `compute` gives, as files hold it; None where there is nothing to say.

    A file may come from elsewhere: what is no assessment says nothing.
    """
    if not isinstance(assessment, Mapping):
        return None
    words, share = str(assessment.get("verdict")), assessment.get("sure_below")
    if not WORDS.get(words):
        return None
    number = f" ({share:.0%} below)" if isinstance(share, (int, float)) else ""
    return f"{words} here{number}: {WORDS[words]}"

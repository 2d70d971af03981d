"""A number that knows without labels what a net is worth: how much of its sure floor another net contradicts.

What never crosses the horizon (a desk, a car) may look like floor to a net that learned from the horizon
alone, and then it is as sure of it as of the floor. The net of the simulated worlds (`models/start.py`) never
saw the recording and knows what stands on a floor: the share of the pixels below the horizon that the one is
sure are floor and the other calls an obstacle is what may be missed. Over eight sets, three seeds each, its
rank correlation with the AUC within depression bands is -.83 (docs/RESEARCH.md).
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

SURE_BELOW, OBSTACLE = 0.3, 0.5
"""`p_above` under which a net is sure of the floor, and the other's probability over which it is one of an
obstacle. Picked with the number itself, one of 21, on eight sets."""
DOUBTFUL, NOT_TO_BE_TRUSTED = 0.16, 0.24
"""Picked on the same eight sets with nets of an earlier start. Share (AUC within) with today's: arena .07
(.98), embedded .08 (.97), hallway .09 (.91), corridor .10 (.97); KITTI .16 (.89); icl_office_kt3 .28 (.17),
room .32 (.84), tum_fr1_rpy .48 (.87)."""
WORDS = {
    "ok": "",
    "doubtful": "low obstacles and shade may be missed",
    "not to be trusted": "obstacles are told poorly",
}


class SelfAssessment:
    """Share of the pixels below the horizon, over unlabelled training frames, whose floor is contradicted.

    Example:
        >>> assessment = SelfAssessment()
        >>> p_above, p_obstacle = np.array([[0.9, 0.4, 0.1, 0.2]]), np.array([[0.9, 0.9, 0.8, 0.1]])
        >>> assessment.update(p_above, p_obstacle, np.array([[0.1, -0.1, -0.2, -0.3]]))
        >>> assessment.compute()["contradicted"] == 1 / 3, assessment.compute()["verdict"]
        (True, 'not to be trusted')
    """

    def __init__(self) -> None:
        self._below = self._sure = self._contradicted = 0

    def update(
        self,
        p_above: NDArray[np.floating],
        p_obstacle: NDArray[np.floating],
        elevation: NDArray[np.floating],
    ) -> None:
        """Count a frame.

        Args:
            p_above: (h, w) in [0, 1], of the net that is assessed.
            p_obstacle: (h, w) in [0, 1], of the net of the simulated worlds.
            elevation: (h, w) rad over the horizon, NaN where not known.
        """
        below = elevation < 0.0
        sure = below & (p_above < SURE_BELOW)
        self._below += int(below.sum())
        self._sure += int(sure.sum())
        self._contradicted += int((sure & (p_obstacle > OBSTACLE)).sum())

    def merge(self, other: "SelfAssessment") -> None:
        """Add everything that another one has counted."""
        self._below += other._below
        self._sure += other._sure
        self._contradicted += other._contradicted

    def state(self) -> dict[str, NDArray[Any]]:
        """All that was counted, as arrays by name."""
        return {"counts": np.array([self._below, self._sure, self._contradicted], np.int64)}

    def load(self, state: dict[str, NDArray[Any]]) -> None:
        """Take a state in place of what was counted."""
        self._below, self._sure, self._contradicted = state["counts"].tolist()

    def compute(self) -> dict[str, Any]:
        """Shares of the pixels below the horizon, None before any, and what they say of the net.

        `sure_below`: it is sure are floor; `contradicted`: and the other net calls obstacle; `verdict`: ok,
        doubtful, not to be trusted.
        """
        sure, share = (
            count / self._below if self._below else None for count in (self._sure, self._contradicted)
        )
        return {"sure_below": sure, "contradicted": share, "verdict": verdict(share)}


def verdict(share: float | None) -> str:
    """The share in words.

    Example:
        >>> verdict(0.1), verdict(0.2)
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
    words, share = str(assessment.get("verdict")), assessment.get("contradicted")
    if not WORDS.get(words):
        return None
    if not isinstance(share, (int, float)):
        return f"{words} here: {WORDS[words]}"
    seen = "of the ground is floor where the net of the simulated worlds sees an obstacle"
    return f"{words} here: it is sure that {share:.0%} {seen}; {WORDS[words]}"

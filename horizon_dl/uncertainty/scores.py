"""Obstacle scores of one frame, by name."""

import numpy as np
from numpy.typing import NDArray

from horizon_dl.geometry.view import View
from horizon_dl.targets.targets import make_target
from horizon_dl.uncertainty.measures import binary_entropy, measures, p_other_side

Map = NDArray[np.float32]

P_ABOVE = "p_above"
SCORES = ("entropy", "single_pass_entropy", "expected_entropy", "mutual_information", "surprisal", "fused")


def score_maps(view: View, p_above_samples: Map, single_pass: Map | None = None) -> dict[str, Map]:
    """All obstacle scores of a learner on one view, each (h, w) in [0, 1].

    `surprisal` stands as the probability of the other side, `1 - 2 ** -surprisal`: the same order, bounded.

    Args:
        view: the frame.
        p_above_samples: (N, h, w) in [0, 1], one map a dropout sample or tree.
        single_pass: (1, h, w) `p_above` without dropout, for learners that have it.
    """
    above = view.elevation > 0
    found = measures(p_above_samples, above)
    maps = {
        P_ABOVE: found.p_above,
        "entropy": found.entropy,
        "expected_entropy": found.expected_entropy,
        "mutual_information": found.mutual_information,
        "surprisal": p_other_side(found.p_above, above),
        "fused": fused_score(view, found.p_above),
    }
    if single_pass is not None:
        maps["single_pass_entropy"] = binary_entropy(single_pass[0])
    return maps


def fused_score(view: View, p_above: Map) -> Map:
    """Entropy of the mean of the learner's `p_above` and the frame's own diffused horizon label."""
    own = np.nan_to_num(make_target("geodesic", view), nan=0.5)
    return binary_entropy((p_above + own) / 2)

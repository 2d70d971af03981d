"""Obstacle scores of one frame, by name."""

import numpy as np
from numpy.typing import NDArray

from horizon_dl.data.view import View
from horizon_dl.targets.geodesic import (
    LEAST_P,
    horizon_distance,
    relative_angle,
    relative_geodesic_position,
    traversal_cost,
)
from horizon_dl.targets.geodesic_params import GEODESIC, GeodesicParams
from horizon_dl.uncertainty.measures import P_ABOVE, Measures, binary_entropy, log_odds, p_other_side

Map = NDArray[np.float32]

SCORES = (
    "entropy",
    "expected_entropy",
    "mutual_information",
    "surprisal",
    "fused",
    "single_pass_entropy",
)
"""All of a learner; the last of those that have a pass without dropout."""

# Both weights were picked on arena, corridor, hallway, KITTI and embedded: expect less elsewhere.
FRAME_WEIGHT = 0.5
PRIOR_WEIGHT = 0.5
AGREED = 0.65
"""From this `path_agreement` on the paths count. Picked on eight sets and eleven simulated worlds.

Under it lie room and tum_fr1_rpy (.35 to .57), where paths cost up to .11 within bands; over it embedded,
KITTI, hallway, corridor and arena (.74 to .84), where they gain up to .03. It helps six of
the worlds, by up to .05, and costs four up to .01.
"""
SHARE_MARGIN = 0.02
"""The relative position is kept this far from 0 and 1, where its log odds would drown the others."""


def score_maps(
    view: View,
    found: Measures,
    single_pass: Map | None = None,
    paths: GeodesicParams = GEODESIC,
    agreement: float | None = None,
) -> dict[str, Map]:
    """All obstacle scores of a learner on one view, each (h, w) in [0, 1].

    `surprisal` stands as the probability of the other side, `1 - 2 ** -surprisal`: the same order, bounded.

    Args:
        view: the frame.
        found: the learner's measures of it.
        single_pass: (h, w) `p_above` without dropout, for learners that have it.
        paths: what the paths of the fused score cost.
        agreement: see `fused_score`.
    """
    maps = {
        P_ABOVE: found.p_above,
        "entropy": found.entropy,
        "expected_entropy": found.expected_entropy,
        "mutual_information": found.mutual_information,
        "surprisal": p_other_side(found.p_above, view.elevation > 0),
        "fused": fused_score(view, found.p_above, paths, agreement),
    }
    if single_pass is not None:
        maps["single_pass_entropy"] = binary_entropy(single_pass)
    return maps


def fused_score(
    view: View, p_above: Map, paths: GeodesicParams = GEODESIC, agreement: float | None = None
) -> Map:
    """What the learner says, what the frame itself shows, and what is known of the place, added as log odds.

    The log odds of the other side, `logit p`; those of `relative_geodesic_position`, where the pixel lies on
    the path from what the learner is surest of in this frame to the horizon, along paths that avoid edges;
    minus the angle from the horizon over its mean, a geometric prior: near the horizon obstacles are likelier
    than floor. The weights are fixed for all data; picked on arena, corridor, hallway, KITTI and embedded.
    The paths are left out where they and the learner contradict each other on the training frames.

    Args:
        view: the frame.
        p_above: (h, w) what the learner says.
        paths: what paths cost.
        agreement: mean `path_agreement` of learner and paths on training frames; None where it is not known.

    Returns:
        (h, w) in [0, 1].
    """
    evidence = log_odds(p_other_side(p_above, view.elevation > 0), LEAST_P)
    evidence = evidence - PRIOR_WEIGHT * relative_angle(view.elevation)
    if agreement is None or agreement >= AGREED:
        cost = traversal_cost(view.image, view.elevation, p_above, paths)
        distance = horizon_distance(cost, view.elevation)
        share = relative_geodesic_position(cost, view.elevation, p_above, distance, paths)
        evidence = evidence + FRAME_WEIGHT * log_odds(
            SHARE_MARGIN + (1.0 - 2.0 * SHARE_MARGIN) * share, LEAST_P
        )
    fused: Map = np.nan_to_num(1.0 / (1.0 + np.exp(-evidence))).astype(np.float32)
    return fused

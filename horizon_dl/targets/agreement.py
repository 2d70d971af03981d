"""How far a learner and the paths through an image agree on what below the horizon is obstacle.

Two views of one pixel: what the learner takes its appearance for, and where paths that cross no edge place it
between the sure floor and the horizon. Where obstacles stand apart from a floor of one piece both tell the
same; among furniture whose own surfaces are as large as the floor the paths place tops of desks with it, and
what a net learns from context is the place in the scene, not the thing. Compared within bands of depression,
where the place alone says nothing. Needs no label.
"""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray
from scipy.stats import rankdata

from horizon_dl.data.view import View
from horizon_dl.geometry.resize import area_resize, halved
from horizon_dl.targets.geodesic import horizon_distance, relative_geodesic_position, traversal_cost
from horizon_dl.targets.geodesic_params import GEODESIC, GeodesicParams

LEAST_PIXELS = 30
"""A band of fewer says nothing."""
UNSEEN_DEG = 1.0
"""This close to the horizon the attitude's error decides the side."""

Map = NDArray[np.float32]


def path_agreement(view: View, p_above: Map, params: GeodesicParams = GEODESIC) -> float:
    """Rank correlation, within bands of one degree, of `p_above` with the relative geodesic position.

    Args:
        view: at the working size; compared at half of it, which takes a quarter of the time.
        p_above: (h, w) in [0, 1], a learner's.
        params: what paths cost, and what is sure.

    Returns:
        In [-1, 1], mean over the bands weighted by their pixels; NaN where no band has pixels to compare.
    """
    elevation, p_above = halved(view.elevation), halved(p_above)
    image = area_resize(view.image, (elevation.shape[1], elevation.shape[0]))
    cost = traversal_cost(image, elevation, p_above, params)
    distance = horizon_distance(cost, elevation)
    share = relative_geodesic_position(cost, elevation, p_above, distance, params)
    return rank_correlation_within_bands(p_above, share, elevation)


def rank_correlation_within_bands(one: Map, other: Map, elevation: Map) -> float:
    """Spearman's rank correlation of two maps below the horizon, within bands of one degree.

    Returns:
        Mean over the bands weighted by their pixels; bands in which a map does not change are left out, NaN
        if all are.
    """
    depression_deg = -np.rad2deg(elevation)
    below = depression_deg > UNSEEN_DEG  # False for NaN
    first, second, degree = one[below], other[below], depression_deg[below].astype(int)
    total, pixels = 0.0, 0
    for band in np.unique(degree):
        chosen = degree == band
        ranks = np.stack([rankdata(values[chosen]) for values in (first, second)])
        if ranks.shape[1] < LEAST_PIXELS or (np.ptp(ranks, axis=1) == 0.0).any():
            continue
        total += float(np.corrcoef(ranks)[0, 1]) * ranks.shape[1]
        pixels += ranks.shape[1]
    return total / pixels if pixels else float("nan")


def mean_agreement(agreements: Iterable[float]) -> float | None:
    """Mean over frames, without those that say nothing; None where none says anything.

    Example:
        >>> mean_agreement([0.5, float("nan"), 0.7])
        0.6
    """
    known = [value for value in agreements if not np.isnan(value)]
    return float(np.mean(known)) if known else None

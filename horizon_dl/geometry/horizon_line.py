"""Which way is up, from the line that parts a picture best: sea from sky, or a map of what is above."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from horizon_dl.geometry.tilts import UpEstimate, estimate, roll_pitch_of, tilts

Floats = NDArray[np.float64]
Likelihood = Callable[[Floats], Floats]

COARSE, FINE = np.radians(2.0), np.radians(0.5)
LEAST_SHARE = 0.03
"""A line with less than this part of the picture on one side separates nothing."""
CLEAR = 3.0
"""By so much the colours' log determinant must fall for a line between them: sky and sea, no furniture."""
SAMPLES = 60.0
"""How many independent samples a picture is worth: neighbouring pixels say the same."""


def up_from_map(p_above: NDArray[np.floating], directions: NDArray[np.floating]) -> UpEstimate | None:
    """The horizon that agrees best with a map of what is above; None where all is on one side.

    Args:
        p_above: (h, w) in [0, 1].
        directions: (h, w, 3) unit rays of its pixels, NaN where there is none.
    """
    rays, values = _flat(directions, p_above[..., None])
    if not LEAST_SHARE < (values > 0.5).mean() < 1 - LEAST_SHARE:
        return None
    log_odds = np.clip(np.log(np.clip(values, 0.02, 0.98) / (1 - np.clip(values, 0.02, 0.98))), -3, 3)

    def likelihood(ups: Floats) -> Floats:
        above = rays @ ups.T > 0
        total: Floats = (np.where(above, 1.0, -1.0) * log_odds).mean(axis=0) * SAMPLES / 2
        return np.where(_parts(above), total, -np.inf)

    return _searched(likelihood)


def up_from_colours(image: NDArray[np.uint8], directions: NDArray[np.floating]) -> UpEstimate | None:
    """The line on whose sides the colours differ most and are evenest (Ettinger et al., IROS 2002).

    Args:
        image: (h, w, 3) RGB, small.
        directions: (h, w, 3) as of `up_from_map`.
    """
    rays, colours = _flat(directions, image.astype(np.float64) / 255)
    centred = colours - colours.mean(axis=0)
    products = np.einsum("ni,nj->nij", centred, centred).reshape(len(centred), 9)
    features = np.concatenate([np.ones((len(centred), 1)), centred, products], axis=1)
    whole = features.sum(axis=0)
    before = float(_spread(whole[None])[0])

    def likelihood(ups: Floats) -> Floats:
        above = rays @ ups.T > 0
        sums = above.T.astype(np.float64) @ features
        total = _spread(sums) + _spread(whole - sums)
        gain = (before - total) / len(rays)
        return np.where(_parts(above), 0.5 * SAMPLES * gain, -np.inf)

    found = _searched(likelihood)
    gained = 0.0 if found is None else 2 * float(likelihood(found.up_cam[None])[0]) / SAMPLES
    return found if gained > CLEAR else None


def _spread(sums: Floats) -> Floats:
    """(M,) number of pixels times the log determinant of their colours' covariance."""
    count = np.maximum(sums[:, :1], 1.0)
    mean = sums[:, 1:4] / count
    covariance = (sums[:, 4:] / count).reshape(-1, 3, 3) - mean[:, :, None] * mean[:, None, :]
    _, log_determinant = np.linalg.slogdet(covariance + 1e-4 * np.eye(3))
    return np.asarray(count[:, 0] * log_determinant)


def _searched(likelihood: Likelihood) -> UpEstimate | None:
    ups = tilts(COARSE)
    coarse = likelihood(ups)
    if not np.isfinite(coarse).any():
        return None
    rough = estimate(ups, coarse)
    near = tilts(FINE, roll_pitch_of(rough.up_cam), 1.5 * COARSE)
    fine = likelihood(near)
    return UpEstimate(near[int(np.argmax(fine))] if np.isfinite(fine).any() else rough.up_cam, rough.sd_rad)


def _parts(above: NDArray[np.bool_]) -> NDArray[np.bool_]:
    share = above.mean(axis=0)
    parts: NDArray[np.bool_] = (share > LEAST_SHARE) & (share < 1 - LEAST_SHARE)
    return parts


def _flat(directions: NDArray[np.floating], values: NDArray[np.floating]) -> tuple[Floats, Floats]:
    rays = directions.reshape(-1, 3).astype(np.float64)
    known = np.isfinite(rays).all(axis=1)
    return rays[known], values.reshape(len(rays), -1)[known].astype(np.float64)

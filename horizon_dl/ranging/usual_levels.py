"""What a learner usually says of floor and obstacles: the scale on which one picture of it is read."""

from dataclasses import dataclass

from horizon_dl.uncertainty.measures import log_odds

USUAL_CONTRAST = 0.9
"""Log odds; what is taken where nobody was asked."""
LEAST_CONTRAST, MOST_CONTRAST = 0.5, 1.7
"""Log odds; three recordings and nine simulated worlds had .7 to 1.7, beyond that nothing was tried."""
LEAST_P = 1e-3
"""Probabilities count as this far from 0 and 1 at least."""


@dataclass(frozen=True)
class UsualLevels:
    """`p_above` that a learner usually has in a recording, each in [0, 1].

    Attributes:
        floor: of the floor.
        obstacle: the level that best parts what another net takes for obstacles from what it takes for floor
            (`uncertainty/taught_threshold.py`); None where nobody was asked.

    Example:
        >>> round(UsualLevels(0.1, 0.25).contrast, 2), UsualLevels(0.1).contrast
        (1.1, 0.9)
    """

    floor: float
    obstacle: float | None = None

    @property
    def contrast(self) -> float:
        """How far obstacles stand out from the floor, log odds."""
        if self.obstacle is None:
            return USUAL_CONTRAST
        floor, obstacle = log_odds([self.floor, self.obstacle], LEAST_P).tolist()
        return float(min(max(obstacle - floor, LEAST_CONTRAST), MOST_CONTRAST))

"""Names of the methods, as `metrics.json` and `card.json` have them, and what each is called in print."""

from dataclasses import dataclass

NET, FOREST = "cnn", "rf"
DIFFUSION, GEODESIC, POSITION = "diffusion", "geodesic", "position"


@dataclass(frozen=True)
class MethodInfo:
    """What is known of a method without running it.

    Attributes:
        title: in tables and legends.
        headline: the score that it is judged by.
        learns: it has to beat those that do not.
    """

    title: str
    headline: str
    learns: bool


METHODS = {
    NET: MethodInfo("CNN", "surprisal", learns=True),
    FOREST: MethodInfo("forest", "surprisal", learns=True),
    DIFFUSION: MethodInfo("guided diffusion (no learning)", "score", learns=False),
    GEODESIC: MethodInfo("geodesic (no learning)", "score", learns=False),
    POSITION: MethodInfo("position alone", "score", learns=False),
}
LEARNERS = tuple(name for name, method in METHODS.items() if method.learns)

"""Names of the methods, as `metrics.json` and `card.json` have them, and what each is called in print."""

NET, FOREST = "cnn", "rf"
DIFFUSION, GEODESIC, POSITION = "diffusion", "geodesic", "position"

LEARNERS = (NET, FOREST)
TRAINING_FREE = (DIFFUSION, GEODESIC, POSITION)
"""What a learner has to beat."""

TITLES = {
    NET: "CNN",
    FOREST: "forest",
    DIFFUSION: "guided diffusion (no learning)",
    GEODESIC: "geodesic (no learning)",
    POSITION: "position alone",
}
"""In tables and legends."""


def printed_name(method: str) -> str:
    """What a method is called in print; one that is not known here by its own name."""
    return TITLES.get(method, method)

"""Who runs which learner under which seed: dealt out so that all processes end at about the same time."""

from collections.abc import Sequence

from horizon_dl.methods.names import FOREST, NET

Part = tuple[str, int]
"""A learner, and the seed of its run."""

COST = {NET: 1.5, FOREST: 1.0}
"""Time of a run, trained and scored, relative to each other's: measured on corridor and KITTI."""


def dealt(seeds: Sequence[int], processes: int) -> list[list[Part]]:
    """What each process runs; the first one runs all learners of the first seed, and is not named for them.

    The longest part that is left goes to the process that would begin it first.

    Example:
        >>> dealt([0, 1, 2], 2)
        [[('rf', 1)], [('cnn', 1), ('cnn', 2), ('rf', 2)]]
    """
    shares: list[list[Part]] = [[] for _ in range(processes)]
    busy = [sum(COST.values()), *[0.0] * (processes - 1)]
    for learner in sorted(COST, key=lambda name: -COST[name]):
        for seed in seeds[1:]:
            first = busy.index(min(busy))
            shares[first].append((learner, seed))
            busy[first] += COST[learner]
    return shares

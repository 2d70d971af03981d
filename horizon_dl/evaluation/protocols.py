"""Which frames are learned from and which are scored."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, get_args

Protocol = Literal["tail", "labelled-out", "prequential"]
PROTOCOLS: tuple[str, ...] = get_args(Protocol)

TAIL_SHARE = 0.1
TEST_EVERY = 10
FIRST_TEST = 5
WARM_UP_FRAMES = 20


@dataclass(frozen=True)
class Split:
    """Indices of the frames to train on and of those to score, both in time order."""

    train: list[int]
    test: list[int]


def split_frames(protocol: Protocol, labelled: Sequence[bool]) -> Split:
    """Split a recording whose frame i has truth iff `labelled[i]`.

    - `tail`: the first 90 % train, the labelled ones of the last 10 % test.
    - `labelled-out`: the labelled frames test, or frames 5, 15, 25, ... where every frame is labelled;
      all frames but these and their direct neighbours train.
    - `prequential`: all frames train in time order; the labelled ones after the first 20 test.

    A recording without any truth is split as if every frame had one: its figures stay empty, but accuracy
    and pictures are to be had.

    Example:
        >>> split_frames("labelled-out", [False, False, False, True, False, False])
        Split(train=[0, 1, 5], test=[3])
    """
    count = len(labelled)
    has_truth = list(labelled) if any(labelled) else [True] * count
    if protocol == "tail":
        first_test = count - round(TAIL_SHARE * count)
        return Split(list(range(first_test)), [i for i in range(first_test, count) if has_truth[i]])
    if protocol == "prequential":
        return Split(list(range(count)), [i for i in range(WARM_UP_FRAMES, count) if has_truth[i]])
    test = (
        list(range(FIRST_TEST, count, TEST_EVERY))
        if all(has_truth)
        else [i for i in range(count) if has_truth[i]]
    )
    left_out = {j for i in test for j in (i - 1, i, i + 1)}
    return Split([i for i in range(count) if i not in left_out], test)

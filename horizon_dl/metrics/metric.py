"""The one shape of a metric: updated frame by frame, merged with others, computed, kept as a state."""

from collections.abc import Callable, Mapping
from typing import Any, Protocol, Self

import numpy as np
from numpy.typing import NDArray

State = dict[str, NDArray[Any]]
"""All that was counted, as arrays by name: whoever loads it goes on as if nothing had happened."""
SEPARATOR = "."


class Metric(Protocol):
    """What every metric has, in bounded memory."""

    @property
    def update(self) -> Callable[..., Any]:
        """Counts one frame; what it takes is the metric's own."""
        ...

    def merge(self, other: Self) -> None:
        """Add everything that another one has counted."""
        ...

    def compute(self) -> Any:
        """The figures of what was counted so far."""
        ...

    def state(self) -> State:
        """All that was counted."""
        ...

    def load(self, state: State) -> None:
        """Take a state in place of what was counted.

        Raises:
            KeyError, ValueError: it is that of another metric.
        """
        ...


def joined_states(parts: Mapping[str, Metric]) -> State:
    """The states of several metrics as one.

    Args:
        parts: by name; a name holds no `.` that another name begins with.
    """
    return {
        f"{name}{SEPARATOR}{key}": array
        for name, part in parts.items()
        for key, array in part.state().items()
    }


def part_of(state: State, name: str) -> State:
    """The state that was joined under a name."""
    prefix = name + SEPARATOR
    return {key.removeprefix(prefix): array for key, array in state.items() if key.startswith(prefix)}


def names_in(state: State) -> list[str]:
    """The names that a state was joined of, in order."""
    return list(dict.fromkeys(key.partition(SEPARATOR)[0] for key in state))


def loaded(array: NDArray[Any], like: NDArray[Any]) -> NDArray[Any]:
    """A copy of an array of a state, checked against what it replaces; ValueError for another shape."""
    if array.shape != like.shape:
        raise ValueError(f"a state of shape {array.shape} does not fit {like.shape}")
    return np.array(array, like.dtype)

"""Pictures of a bag, read when asked for."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from horizon_dl.data.source import Pixels
from horizon_dl.errors import FrameError, InputError
from horizon_dl.logs.bags.messages import decoder
from horizon_dl.logs.bags.pixels import picture
from horizon_dl.logs.bags.storage import Bag


@dataclass(frozen=True)
class Place:
    """Where a picture lies: its message's time of arrival, and which of those of that time it is."""

    arrival_ns: int
    rank: int


@dataclass
class BagLoader:
    """Reads pictures, forward from where it stands, else by the bag's index; opened anew in every process.

    Attributes:
        path: of the bag.
        topic: of the pictures.
        places: of all frames.
        bits: see `picture`.
        rotate_quarter_turns_ccw: how a picture is turned to be upright.
    """

    path: Path
    topic: str
    places: tuple[Place, ...]
    bits: int = 8
    rotate_quarter_turns_ccw: int = 0
    _bag: Bag | None = field(default=None, repr=False)
    _decode: Any = field(default=None, repr=False)
    _messages: Iterator[tuple[Place, bytes]] | None = field(default=None, repr=False)
    _next: int = 0

    def __call__(self, index: int, with_truth: bool) -> Pixels:
        """See `Loader`."""
        where = f"{self.path.name} {self.topic} {index}"
        try:
            message = self._message(index)
        except FrameError:
            raise
        except InputError as error:
            raise FrameError(where, *error.args[1:]) from None
        image = picture(message, where, self.bits)
        return Pixels(np.ascontiguousarray(np.rot90(image, self.rotate_quarter_turns_ccw)))

    def _message(self, index: int) -> Any:
        if self._bag is None:
            self._bag = Bag(self.path)
            self._decode = decoder(self._bag, self._bag.topics[self.topic])
        topic = self._bag.topics[self.topic]
        place = self.places[index]
        if self._messages is None or index != self._next:
            self._messages = placed(self._bag.messages(topic, place.arrival_ns))
        for attempt in range(2):
            for found, payload in self._messages:
                if found == place:
                    self._next = index + 1
                    return self._decode(payload)
                if found.arrival_ns > place.arrival_ns:
                    break
            if attempt == 0:  # headers in another order than the messages came
                self._messages = placed(self._bag.messages(topic, place.arrival_ns))
        self._messages = None
        raise FrameError(
            f"{self.path.name} {self.topic} {index}", "is not there any more", "copy the bag again"
        )

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_bag": None, "_decode": None, "_messages": None}


def placed(messages: Iterator[tuple[int, bytes]]) -> Iterator[tuple[Place, bytes]]:
    """Payloads with their places, of messages in the order of arrival from a time on."""
    before, rank = None, 0
    for arrival_ns, payload in messages:
        rank = rank + 1 if arrival_ns == before else 0
        before = arrival_ns
        yield Place(arrival_ns, rank), payload

"""Says whether the sectors may be believed; pure, its clock is the caller's."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field

from horizon_dl.vehicle.flight_params import FlightParams

Clock = Callable[[], float]

REASONS_LENGTH = 31


@dataclass
class Watchdog:
    """Watches camera, attitude and model.

    What is late or fails makes everything unknown at once; it recovers by itself when all are good again.

    Attributes:
        clock: monotonic seconds.
        params: what is stale, and how often and how long a trouble is said.
        hint: says more of a stale attitude, where more is known; short.

    Example:
        >>> now = [0.0]
        >>> dog = Watchdog(lambda: now[0])
        >>> dog.camera(); dog.attitude(); dog.result(0.0)
        >>> dog.troubles()
        ()
        >>> now[0] = 1.0
        >>> dog.troubles()
        ('camera stale', 'attitude stale')
    """

    clock: Clock
    params: FlightParams = field(default_factory=FlightParams)
    hint: Callable[[], str] = str
    _camera_s: float | None = None
    _attitude_s: float | None = None
    _result_s: float | None = None
    _model_error: str = ""
    _doubts_s: dict[str, float] = field(default_factory=dict)
    _said: tuple[str, ...] | None = None
    _said_s: float = field(default=0.0)

    def camera(self) -> None:
        """A picture has come."""
        self._camera_s = self.clock()

    def attitude(self) -> None:
        """An attitude has come."""
        self._attitude_s = self.clock()

    def result(self, image_time_s: float) -> None:
        """The model has answered to a picture taken at that time (of the same clock)."""
        self._result_s = image_time_s
        self._model_error = ""

    def model_failed(self, error: str) -> None:
        """The model raised an error; it holds until the next result."""
        self._model_error = error

    def doubt(self, reasons: Iterable[str]) -> None:
        """Why the newest frame, or some of its sectors, are not believed; said to the pilot."""
        self._doubts_s.update({str(reason): self.clock() for reason in reasons})

    def doubts(self) -> tuple[str, ...]:
        """Reasons of the last `doubt_s` seconds, the newest last."""
        now = self.clock()
        newest = list(self._doubts_s.items())  # a copy: another thread adds to it
        return tuple(reason for reason, since_s in newest if now - since_s <= self.params.doubt_s)

    def troubles(self) -> tuple[str, ...]:
        """What is wrong now, most basic first; empty if the newest sectors may be believed."""
        found = []
        if self._stale(self._camera_s):
            found.append("camera stale")
        if self._stale(self._attitude_s):
            found.append(self.hint() or "attitude stale")
        if self._model_error:
            found.append(f"model failed: {self._model_error}")
        elif not found and self._stale(self._result_s):
            found.append(self.hint() or "results stale")
        return tuple(found)

    def to_say(self) -> str | None:
        """The line that is due now for the pilot: on every change, and again while a trouble lasts."""
        troubles, now = self.troubles() or self.doubts(), self.clock()
        changed = troubles != self._said
        if not changed and not (troubles and now - self._said_s >= self.params.repeat_s):
            return None
        first_and_good = self._said is None and not troubles
        self._said, self._said_s = troubles, now
        if troubles:
            return "Obstacles unknown: " + fitting(troubles)
        return "Obstacles: ready" if first_and_good else "Obstacles: recovered"

    def _stale(self, time_s: float | None) -> bool:
        return time_s is None or self.clock() - time_s > self.params.stale_s


def fitting(reasons: Sequence[str]) -> str:
    """As many reasons as a STATUSTEXT holds whole behind "Obstacles unknown: "; the first in any case.

    Example:
        >>> fitting(("net is wrong about horizon", "unfamiliar picture"))
        'net is wrong about horizon'
    """
    text = reasons[0]
    for reason in reasons[1:]:
        if len(text) + len(reason) + 2 <= REASONS_LENGTH:
            text = f"{text}, {reason}"
    return text

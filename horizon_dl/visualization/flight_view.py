"""What a flight looks at, handed to a sink without holding up the loop."""

from dataclasses import replace

from horizon_dl.data.frame import Frame
from horizon_dl.ranging.sectors import FreeDistances
from horizon_dl.runtime.hot_reload import HotReloadedModel
from horizon_dl.runtime.model import Outputs
from horizon_dl.runtime.perception import Perception
from horizon_dl.runtime.predict import of_outputs
from horizon_dl.runtime.ranged import CAR, DRONE, ranged
from horizon_dl.visualization.newest_only import NewestSlot
from horizon_dl.visualization.sink import Sink

Look = tuple[Frame, Outputs, FreeDistances, float, tuple[str, ...]]


class FlightView:
    """Takes a flight's frames as the loop sees them; a thread turns them into predictions for a sink.

    Attributes:
        slot: the thread and its slot; what a slow sink leaves is counted there.
    """

    def __init__(self, model: HotReloadedModel, perception: Perception, sink: Sink) -> None:
        self._model, self._perception, self._sink = model, perception, sink
        self.slot: NewestSlot[Look] = NewestSlot(self._take)

    def look(self, frame: Frame, found: FreeDistances) -> None:
        """A frame, with the attitude it was looked at with, and the sectors that are sent."""
        if self._model.last is not None:
            judged = self._perception.judged
            doubts = () if judged is None else judged.doubts
            self.slot.put((frame, self._model.last, found, self._model.threshold, doubts))

    def close(self) -> None:
        """Show the last frame and close the sink."""
        self.slot.close()
        self._sink.close()

    def _take(self, look: Look) -> None:
        frame, outputs, found, threshold, doubts = look
        prediction = of_outputs(frame, outputs, threshold, self._perception.rays)
        floor = frame.floor_normal
        ranges = None
        if floor is not None:
            vehicle = DRONE if frame.floor_up_cam is None else CAR
            ranges = replace(ranged(found, floor, vehicle, self._perception.forward_cam), doubts=doubts)
        self._sink.log(frame, prediction, ranges)

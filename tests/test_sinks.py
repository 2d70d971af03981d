"""What takes predictions: one protocol, small implementations, and nothing that holds up a flight."""

import threading
import time
from pathlib import Path

import numpy as np
import pytest
from scene import scene

from horizon_dl.output.names import ResultNames
from horizon_dl.runtime.ranged import ranges_of
from horizon_dl.visualization.file_sinks import Arrays, Panels
from horizon_dl.visualization.newest_only import NewestOnly
from horizon_dl.visualization.sink import Sink, closing


class Count:
    """The worked example of the documentation: a sink is these two methods."""

    def __init__(self) -> None:
        self.frames: list[str] = []
        self.closed = False

    def log(self, frame, prediction, ranges) -> None:
        self.frames.append(frame.name)

    def close(self) -> None:
        self.closed = True


def test_a_sink_is_two_methods() -> None:
    sink: Sink = Count()
    with closing([sink]) as sinks:
        frame, prediction = scene()
        sinks.log(frame, prediction, ranges_of(frame, prediction))
    assert sink.frames == ["cam/000.png"]
    assert sink.closed


def test_all_are_closed_even_where_one_fails() -> None:
    class Broken(Count):
        def close(self) -> None:
            raise OSError("disk full")

    last = Count()
    with pytest.raises(OSError, match="disk full"), closing([Broken(), last]):
        pass
    assert last.closed


def test_equal_stems_do_not_overwrite_each_other(tmp_path: Path) -> None:
    frame, prediction = scene()
    names = ["x/a/1.png", "x/b/1.png", "x/b/1.jpg", "../../etc/1.png"]
    panels, arrays = Panels(tmp_path / "p", ResultNames(names)), Arrays(tmp_path / "a", ResultNames(names))
    for name in names:
        renamed = type(frame)(**{**vars(frame), "name": name})
        panels.log(renamed, prediction, None)
        arrays.log(renamed, prediction, None)
    assert len(list((tmp_path / "p").rglob("*.jpg"))) == 4
    written = list((tmp_path / "a").rglob("*.npz"))
    assert len(written) == 4
    assert np.load(written[0])["entropy"].shape == prediction.measures.entropy.shape


def test_a_slow_viewer_holds_nobody_up() -> None:
    class Slow(Count):
        def log(self, frame, prediction, ranges) -> None:
            time.sleep(0.2)
            super().log(frame, prediction, ranges)

    slow, (frame, prediction) = Slow(), scene()
    sink = NewestOnly(slow)
    start = time.perf_counter()
    for _ in range(200):
        sink.log(frame, prediction, None)
    took_s = time.perf_counter() - start
    sink.close()
    assert took_s < 0.2  # one frame of the slow one, for two hundred
    assert slow.closed
    assert len(slow.frames) + sink.slot.dropped == 200
    assert 1 <= len(slow.frames) <= 3


def test_a_viewer_that_fails_ends_alone() -> None:
    failed = threading.Event()

    class Broken(Count):
        def log(self, frame, prediction, ranges) -> None:
            failed.set()
            raise ValueError("no")

    sink, (frame, prediction) = NewestOnly(Broken()), scene()
    sink.log(frame, prediction, None)
    assert failed.wait(5)
    sink.log(frame, prediction, None)
    sink.close()
    assert isinstance(sink.slot.error, ValueError)

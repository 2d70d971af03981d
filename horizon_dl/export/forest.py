"""The paper's forest as a model file, so that the comparison can be flown."""

import time
from collections.abc import Callable
from typing import Any

from horizon_dl.config import Config
from horizon_dl.data.source import Recording
from horizon_dl.export.card import make_forest_card
from horizon_dl.export.export import Exported, exported, parity_frames
from horizon_dl.export.parity import feed_of, sample_frames
from horizon_dl.methods.learners import fit_forest, forest_threshold
from horizon_dl.runtime.benchmark import quartiles, timed_in_turn
from horizon_dl.runtime.model import camera_from_card, new_session
from horizon_dl.training.context import agreement_of
from horizon_dl.training.frame_store import FrameStore
from horizon_dl.uncertainty.measures import P_ABOVE

PARITY_FRAMES = 2
RUNS = 10


def export_forest(recording: Recording, config: Config) -> Exported:
    """Fit the forest on all frames of a recording and export it for that recording's camera.

    Raises:
        InputError: too many frames cannot be used, or they do not show both sides of the horizon.
        RuntimeError: the file does not say what the forest says.
    """
    store = FrameStore(recording, config)
    indices = range(recording.length)
    start = time.perf_counter()
    method = fit_forest(store, indices, config.seed)
    train_s = time.perf_counter() - start
    forest = method.forest
    threshold = forest_threshold(method, store, indices)
    agreement = agreement_of(lambda view: method.quick_maps(view)[P_ABOVE], store, indices)
    card = make_forest_card(forest, recording, config, threshold, train_s, agreement)
    frames = parity_frames(recording)[:PARITY_FRAMES]
    return exported(forest, config.image.max_pixels, threshold, card, frames)


def with_cost(forest: Exported, net: Exported) -> Exported:
    """The forest with its cost in its card: milliseconds a frame beside the net's, in turn, at one thread."""
    times = timed_in_turn({"forest": _job(forest), "net": _job(net)}, RUNS)
    medians = {name: quartiles(found)["median_ms"] for name, found in times.items()}
    cost = {
        "threads": 1,
        "forest_ms": medians["forest"],
        "net_ms": medians["net"],
        "times_as_long": medians["forest"] / medians["net"],
        "forest_bytes": len(forest.content()),
        "net_bytes": len(net.content()),
    }
    return forest.with_card(cost=cost)


def cost_line(cost: dict[str, Any]) -> str:
    """The cost in words.

    Example:
        >>> cost = {"forest_ms": 160.0, "times_as_long": 32.0, "forest_bytes": 9100000, "net_bytes": 3e5}
        >>> cost_line(cost)
        'forest: 160 ms a frame at one thread, 32 times as long as the net; 9.1 MB, the net 0.3 MB'
    """
    times = f"{cost['forest_ms']:.0f} ms a frame at one thread, {cost['times_as_long']:.0f} times as long"
    sizes = f"{cost['forest_bytes'] / 1e6:.1f} MB, the net {cost['net_bytes'] / 1e6:.1f} MB"
    return f"forest: {times} as the net; {sizes}"


def _job(model: Exported) -> Callable[[], object]:
    feed = feed_of(sample_frames(camera_from_card(model.card), 1)[0])
    session = new_session(model.content(), 1)
    return lambda: session.run(None, feed)

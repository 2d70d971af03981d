"""The same model in whole numbers, with what that gains and costs on the user's own data."""

import tempfile
from pathlib import Path
from typing import Any

import onnx
from numpy.typing import NDArray
from onnxruntime.quantization import CalibrationDataReader, QuantFormat, QuantType, quantize_static
from onnxruntime.quantization.shape_inference import quant_pre_process

from horizon_dl.data.frame import Frame
from horizon_dl.data.source import Recording
from horizon_dl.export.export import Exported, parity_frames
from horizon_dl.export.measure import measured
from horizon_dl.export.onnx_file import file_bytes
from horizon_dl.export.parity import feed_of
from horizon_dl.runtime.benchmark import quartiles, timed_in_turn
from horizon_dl.runtime.model import new_session

NAME = "model-int8"
MOST_LOSS = 0.005
RUNS = 60

Feed = dict[str, NDArray[Any]]


class FrameReader(CalibrationDataReader):  # type: ignore[misc]
    """Frames whose activations set the ranges of the whole numbers."""

    def __init__(self, frames: list[Frame]) -> None:
        self._feeds = iter([feed_of(frame) for frame in frames])

    def get_next(self) -> Feed | None:
        """The next frame's inputs, or None at the end."""
        return next(self._feeds, None)


def quantised(graph: onnx.ModelProto, frames: list[Frame]) -> onnx.ModelProto:
    """The graph with the encoder's convolutions in int8, ranges from the frames; all else stays float32."""
    with tempfile.TemporaryDirectory() as folder:
        plain, ready, done = (Path(folder) / f"{name}.onnx" for name in ("plain", "ready", "done"))
        onnx.save(graph, plain)
        quant_pre_process(str(plain), str(ready), skip_symbolic_shape=True)
        nodes = [
            node.name
            for node in onnx.load(ready).graph.node
            if node.op_type == "Conv" and node.name.startswith("/encode")
        ]
        quantize_static(
            str(ready),
            str(done),
            FrameReader(frames),
            quant_format=QuantFormat.QDQ,
            activation_type=QuantType.QUInt8,
            weight_type=QuantType.QInt8,
            per_channel=True,
            nodes_to_quantize=nodes,
        )
        return onnx.load(done)


def write_int8(folder: Path, exported: Exported, data: Recording) -> list[str]:
    """Write `model-int8.onnx`, and say in a few lines whether it is worth it.

    The speed-up is the ratio of median times at one thread, both files in turn in one run; the change of AUC
    is that of the entropy on the labelled frames of the data, where there are any.
    """
    frames = parity_frames(data)
    graph = quantised(exported.graph, frames)
    figures = _compare(exported, graph, frames, data)
    card = {**exported.card, "int8": figures, "parity": None, "measured": figures["measured"]}
    (folder / f"{NAME}.onnx").write_bytes(file_bytes(graph, card, exported.sign))
    return verdict(figures)


def verdict(figures: dict[str, Any]) -> list[str]:
    """What the figures mean, in words.

    Example:
        >>> print(verdict({"float32_ms": 5.0, "int8_ms": 8.0, "speed_up": 0.625, "auc_change": None})[-1])
        int8 is not advised here: it is slower; fly model.onnx
    """
    change = figures["auc_change"]
    auc = "not measured (no truth)" if change is None else f"{change:+.4f}"
    times = f"{figures['float32_ms']:.2f} to {figures['int8_ms']:.2f} ms"
    lines = [f"int8: {times} at one thread, {figures['speed_up']:.2f} times as fast; AUC {auc}"]
    reasons = ["it is slower"] * (figures["speed_up"] <= 1)
    reasons += ["it costs AUC"] * (change is not None and change < -MOST_LOSS)
    if reasons:
        lines.append(f"int8 is not advised here: {' and '.join(reasons)}; fly model.onnx")
    return lines


def _compare(
    exported: Exported, graph: onnx.ModelProto, frames: list[Frame], data: Recording
) -> dict[str, Any]:
    float32, int8 = exported.content(), file_bytes(graph, exported.card)
    feed = feed_of(frames[0])
    sessions = {"float32": new_session(float32, 1), "int8": new_session(int8, 1)}
    times = timed_in_turn({name: _job(session, feed) for name, session in sessions.items()}, RUNS)
    medians = {name: quartiles(found)["median_ms"] for name, found in times.items()}
    before = exported.card.get("measured")
    after = measured(int8, data) if before else None
    return {
        "float32_ms": medians["float32"],
        "int8_ms": medians["int8"],
        "speed_up": medians["float32"] / medians["int8"],
        "auc_change": after["auc"] - before["auc"] if before and after else None,
        "measured": after,
    }


def _job(session: Any, feed: Feed) -> Any:
    return lambda: session.run(None, feed)

"""Writing the graph as an ONNX file with its card and seal inside."""

import json
import tempfile
import warnings
from pathlib import Path
from typing import Any

import onnx
import torch

from horizon_dl import __version__
from horizon_dl.export.card import INPUTS, KIND, OUTPUTS
from horizon_dl.export.graph import Pipeline
from horizon_dl.quiet import quiet_logger
from horizon_dl.runtime.checksum import BLANK, BLANK_SIGNED, checksummed
from horizon_dl.runtime.model import CARD_KEY
from horizon_dl.runtime.signature import Signer

OPSET = 18
RANDOM_OPERATORS = {
    "Bernoulli",
    "Dropout",
    "Multinomial",
    "RandomNormal",
    "RandomNormalLike",
    "RandomUniform",
    "RandomUniformLike",
}


def graph_of(module: Pipeline) -> onnx.ModelProto:
    """The module as an ONNX graph with named and described inputs and outputs.

    The exporter that traces is used: it needs no further package and writes no source locations.

    Raises:
        RuntimeError: an operator of the graph is random, or a dropout that runtimes remove.
    """
    width, height = module.image_size
    image = torch.zeros(1, height, width, 3, dtype=torch.uint8)
    quiet = quiet_logger("torch.onnx")
    with warnings.catch_warnings(), quiet, torch.inference_mode(), tempfile.TemporaryDirectory() as folder:
        warnings.simplefilter("ignore")
        torch.onnx.export(
            module.eval(),
            (image, torch.tensor([0.0, -1.0, 0.0])),
            Path(folder) / "graph.onnx",
            dynamo=False,
            opset_version=OPSET,
            custom_opsets=module.further_opsets,
            input_names=list(INPUTS),
            output_names=list(OUTPUTS),
        )
        graph = onnx.load(Path(folder) / "graph.onnx")
    found = RANDOM_OPERATORS & {node.op_type for node in graph.graph.node}
    if found:
        raise RuntimeError(f"the graph holds {', '.join(sorted(found))}; a deployed graph may not be random")
    for value in (*graph.graph.input, *graph.graph.output):
        value.doc_string = {**INPUTS, **OUTPUTS}[value.name]
    return graph


def file_bytes(graph: onnx.ModelProto, card: dict[str, Any], sign: Signer | None = None) -> bytes:
    """The checksummed file of a graph and its card, signed if asked for."""
    file = onnx.ModelProto()
    file.CopyFrom(graph)
    file.doc_string = BLANK if sign is None else BLANK_SIGNED
    file.producer_name, file.producer_version = "horizon-dl", __version__
    file.graph.name = "obstacles"
    texts = {"kind": KIND, CARD_KEY: json.dumps(card, allow_nan=False)}
    texts |= {key: card[key] for key in ("what", "limits", "licence", "patents", "weights_sha256")}
    onnx.helper.set_model_props(file, texts)
    onnx.checker.check_model(file, full_check=True)
    return checksummed(file.SerializeToString(deterministic=True), sign)

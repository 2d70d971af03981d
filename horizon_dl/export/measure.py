"""What a model file earns on labelled data, for its card."""

import tempfile
from pathlib import Path
from typing import Any

from horizon_dl.data.source import Recording
from horizon_dl.evaluation.evaluate import evaluate
from horizon_dl.methods.onnx_file import load_file_run


def measured(content: bytes, data: Recording) -> dict[str, Any]:
    """AUC of the entropy and the rates at the threshold, below the horizon, before the neighbour filter."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "model.onnx"
        path.write_bytes(content)
        run = load_file_run(path)
        metrics = evaluate(run, data).metrics
    block = metrics["methods"][run.learner]
    scores, point = block["scores"]["entropy"], block["operating_point"]
    return {
        "data": metrics["data"],
        "frames": metrics["frames"]["test"],
        "score": "entropy",
        **{key: scores[key] for key in ("auc", "auc_within_depression", "ap", "fpr95")},
        **{key: point[key] for key in ("threshold", "tpr", "fpr", "tpr_filtered", "fpr_filtered")},
    }

"""One door for everything that predicts: a run folder, or the file that was exported from it."""

from pathlib import Path

from horizon_dl.data.regular_file import check_there
from horizon_dl.runtime.prediction import Predictor


def open_predictor(path: Path) -> Predictor:
    """The predictor in a run folder or an `.onnx` file; only a run folder needs torch.

    Raises:
        InputError: it is neither, or damaged.

    Example:
        >>> open_predictor(Path("model.onnx")).predict(frame)   # doctest: +SKIP
    """
    check_there(path)
    if is_model_file(path):
        from horizon_dl.runtime.model import ObstacleModel
        from horizon_dl.runtime.predict import FilePredictor

        return FilePredictor(ObstacleModel.load(path), path.name)
    from horizon_dl.training.predict import load_run_predictor

    return load_run_predictor(path)


def is_model_file(path: Path) -> bool:
    """Whether a MODEL is an exported file and no run folder."""
    return path.suffix == ".onnx" or path.is_file()

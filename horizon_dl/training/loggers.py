"""Where the curves of a training go: one of Lightning's loggers, named in the config."""

from pathlib import Path
from typing import Any

import numpy as np
from lightning.pytorch.loggers import CSVLogger, Logger, TensorBoardLogger
from numpy.typing import NDArray

from horizon_dl.config import LoggerConfig
from horizon_dl.errors import InputError


def open_logger(settings: LoggerConfig, folder: Path) -> Logger | None:
    """The logger that the config names, or None for `none`.

    What it writes stays in the folder and on this machine unless its options say otherwise.

    Args:
        settings: `logger` of the config.
        folder: of the run.

    Raises:
        InputError: its package is not installed, or an option is not one of its own.
    """
    if settings.kind == "none":
        return None
    try:
        return _MAKERS[settings.kind](folder, settings.options)
    except ModuleNotFoundError as error:
        needs = (error.name or settings.kind).partition(" ")[0]
        raise InputError("logger.kind", f"{settings.kind} needs {needs}", f"pip install {needs}") from None
    except TypeError as error:
        raise InputError("logger.options", f"do not fit {settings.kind} ({error})", "correct them") from None


def log_picture(logger: Logger, name: str, picture: NDArray[np.uint8], step: int) -> None:
    """A picture, (h, w, 3) RGB, to loggers that take pictures; the others leave it out."""
    any_logger: Any = logger  # each kind has a way of its own
    if isinstance(logger, TensorBoardLogger):
        any_logger.experiment.add_image(name, picture, step, dataformats="HWC")
    elif hasattr(logger, "log_image"):  # Weights & Biases
        any_logger.log_image(name, [picture], step=step)
    elif hasattr(logger, "run_id"):  # MLflow
        any_logger.experiment.log_image(any_logger.run_id, picture, f"{name}/{step:06d}.png")


def _tensorboard(folder: Path, options: dict[str, Any]) -> Logger:
    return TensorBoardLogger(folder, **{"name": "tensorboard", "version": "", **options})


def _csv(folder: Path, options: dict[str, Any]) -> Logger:
    return CSVLogger(folder, **{"name": "csv", "version": "", **options})


def _mlflow(folder: Path, options: dict[str, Any]) -> Logger:
    from lightning.pytorch.loggers import MLFlowLogger

    return MLFlowLogger(**{"save_dir": str(folder / "mlruns"), "experiment_name": "horizon_dl", **options})


def _wandb(folder: Path, options: dict[str, Any]) -> Logger:
    from lightning.pytorch.loggers import WandbLogger

    return WandbLogger(**{"save_dir": folder, "project": "horizon_dl", "offline": True, **options})


_MAKERS = {"tensorboard": _tensorboard, "csv": _csv, "mlflow": _mlflow, "wandb": _wandb}

"""Obstacles from the uncertainty about what lies above and below the horizon.

What others build on is imported from here, each name when it is first asked for, so that the plain
install has what it can have:

    >>> from horizon_dl import Camera
    >>> Camera("pinhole", 640, 480, 500.0, 500.0, 319.5, 239.5).scaled(320, 240).cx
    159.5
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

__version__ = "0.1.0"

if TYPE_CHECKING:
    from horizon_dl.config import Config, load_config
    from horizon_dl.data.frame import Frame
    from horizon_dl.data.given import Given
    from horizon_dl.data.source import FrameSource, Recording
    from horizon_dl.errors import InputError
    from horizon_dl.evaluation.compare import compare
    from horizon_dl.export.export import export_run as export
    from horizon_dl.geometry.camera import Camera
    from horizon_dl.runtime.flight_loop import FlightLoop
    from horizon_dl.runtime.model import ObstacleModel
    from horizon_dl.sources.open_source import open_source
    from horizon_dl.training.online.learner import OnlineLearner
    from horizon_dl.training.train import train_run as train

__all__ = [
    "Camera",
    "Config",
    "FlightLoop",
    "Frame",
    "FrameSource",
    "Given",
    "InputError",
    "ObstacleModel",
    "OnlineLearner",
    "Recording",
    "compare",
    "export",
    "load_config",
    "open_source",
    "train",
]

_PLACES = {
    "Camera": "geometry.camera:Camera",
    "Config": "config:Config",
    "FlightLoop": "runtime.flight_loop:FlightLoop",
    "Frame": "data.frame:Frame",
    "FrameSource": "data.source:FrameSource",
    "Given": "data.given:Given",
    "InputError": "errors:InputError",
    "ObstacleModel": "runtime.model:ObstacleModel",
    "OnlineLearner": "training.online.learner:OnlineLearner",
    "Recording": "data.source:Recording",
    "compare": "evaluation.compare:compare",
    "export": "export.export:export_run",
    "load_config": "config:load_config",
    "open_source": "sources.open_source:open_source",
    "train": "training.train:train_run",
}


def __getattr__(name: str) -> Any:
    """A public name, from its module; ImportError names the extra that lacks."""
    if name not in _PLACES:
        raise AttributeError(f"module 'horizon_dl' has no attribute '{name}'")
    module, _, attribute = _PLACES[name].partition(":")
    try:
        return getattr(import_module(f"horizon_dl.{module}"), attribute)
    except ModuleNotFoundError as error:
        if (error.name or "").startswith("horizon_dl"):
            raise
        problem = f"horizon_dl.{name} needs {error.name}; pip install 'horizon-dl[train]'"
        raise ImportError(problem, name=error.name) from None


def __dir__() -> list[str]:
    return sorted([*globals(), *__all__])

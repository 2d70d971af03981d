"""A model file that is followed: when a fresh one takes its place, it is flown from the next frame on."""

import threading
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from horizon_dl.errors import InputError
from horizon_dl.runtime.acceptance import not_airworthy
from horizon_dl.runtime.model import ObstacleModel, Outputs
from horizon_dl.runtime.signature import Verifier

Stamp = tuple[int, int, int]


class HotReloadedModel:
    """An `ObstacleModel` that looks at every prediction whether its file was replaced.

    The new file is loaded in a thread while the old one predicts, and takes over between two frames: no frame
    waits, none is dropped. A file that is damaged, made for another camera or size, or not to be flown (see
    `acceptance`) is refused, and the old one flies on.

    Attributes:
        current: the model that predicted last.
        camera: of the upright images it takes; the same for all files.
        place: what the training pictures of the current model were like.
        rules: of ranging, evidence and watchdog, of the current model.
        threshold: entropy above which a pixel is an obstacle, bits; of the current model.
        taken_over: how often a fresh file took over.
        refused: files that were not taken.
        problem: of the last file refused.
        last: what the model said last, for those who watch.
    """

    def __init__(
        self,
        model: ObstacleModel,
        path: Path,
        threads: int,
        as_loaded: Stamp | None,
        trusted: Verifier | None = None,
    ) -> None:
        self.taken_over = self.refused = 0
        self.problem: str | None = None
        self.last: Outputs | None = None
        self._path, self._threads, self._trusted = path, threads, trusted
        self._take(model)
        self._stamp = as_loaded
        self._loader: threading.Thread | None = None
        self._fresh: ObstacleModel | None = None

    @classmethod
    def load(cls, path: str | Path, threads: int = 1, trusted: Verifier | None = None) -> "HotReloadedModel":
        """As `ObstacleModel.load`."""
        as_loaded = stamp(Path(path))  # before it is read: a file that comes meanwhile is a fresh one
        return cls(ObstacleModel.load(path, threads, trusted), Path(path), threads, as_loaded, trusted)

    def predict(self, image: NDArray[np.uint8], up_cam: ArrayLike | None = None) -> Outputs:
        """Maps of one frame by the newest file that fits; see `ObstacleModel.predict`."""
        self._follow()
        self.last = self.current.predict(image, up_cam)
        return self.last

    def summary(self) -> dict[str, Any]:
        """Counts, ready for JSON."""
        return {"taken_over": self.taken_over, "refused": self.refused, "problem": self.problem}

    def _follow(self) -> None:
        if self._loader is not None:
            if self._loader.is_alive():
                return
            self._loader = None
            if self._fresh is not None:
                self._take(self._fresh)
                self._fresh = None
                self.taken_over += 1
        found = stamp(self._path)
        if found is not None and found != self._stamp:
            self._stamp = found
            self._loader = threading.Thread(target=self._load, name="model", daemon=True)
            self._loader.start()

    def _take(self, model: ObstacleModel) -> None:
        self.current, self.camera, self.threshold = model, model.camera, model.threshold
        self.place, self.rules = model.place, model.rules

    def _load(self) -> None:
        try:
            fresh = ObstacleModel.load(self._path, self._threads, self._trusted)
            problem = not_airworthy(fresh, fresh.rules.evidence)
            if problem is not None:
                raise InputError(self._path, problem, "the old one flies on")
            if (fresh.camera, fresh.size) != (self.camera, self.current.size):
                raise InputError(
                    self._path, "was exported for another camera or size", "the old one flies on"
                )
        except InputError as error:
            self.refused += 1
            self.problem = str(error)
        else:
            self._fresh = fresh


def stamp(path: Path) -> Stamp | None:
    """What changes when a file is replaced: its number, time and length; None without a file."""
    try:
        found = path.stat()
    except OSError:
        return None
    return found.st_ino, found.st_mtime_ns, found.st_size

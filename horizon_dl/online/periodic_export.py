"""Fresh model files of a net that goes on learning."""

import threading
import time
from collections.abc import Callable
from pathlib import Path

from horizon_dl.export.export import export_run
from horizon_dl.geometry.camera import Camera
from horizon_dl.online.run_directory import KIND
from horizon_dl.output import output_folder
from horizon_dl.runtime.signature import Signer
from horizon_dl.training.run_folder import Run


class PeriodicExport:
    """Writes `model.onnx` again and again, in a thread, so that neither learning nor prediction waits.

    The file appears as a whole: whoever opens it gets the old one or the new. A failed export is counted,
    and the file before it stays.

    Attributes:
        written: files so far.
        failed: exports that were not.
        problem: of the last one that failed.
    """

    def __init__(
        self,
        folder: Path,
        camera: Camera,
        every_s: float,
        sign: Signer | None = None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self.written = self.failed = 0
        self.problem: str | None = None
        self._folder, self._camera, self._every_s, self._clock = folder, camera, every_s, clock
        self._sign = sign
        self._next_s = clock() + every_s
        self._thread: threading.Thread | None = None

    def offer(self, freeze: Callable[[], Callable[[], Run]]) -> None:
        """Export if it is time and the last export is done.

        Args:
            freeze: copies the learner, quickly; what it gives makes the run, in the thread.
        """
        busy = self._thread is not None and self._thread.is_alive()
        if self._clock() < self._next_s or busy:
            return
        self._next_s = self._clock() + self._every_s
        self._thread = threading.Thread(target=self._export, args=(freeze(),), name="export", daemon=True)
        self._thread.start()

    def finish(self, run: Run) -> None:
        """Wait for the thread, then write the last file."""
        self.wait()
        self._export(lambda: run)

    def wait(self) -> None:
        """Until the export at work is done."""
        if self._thread is not None:
            self._thread.join()

    def _export(self, make: Callable[[], Run]) -> None:
        try:
            exported = export_run(make(), self._camera).signed(self._sign)
            with output_folder(self._folder, KIND, adding=True) as folder:
                exported.write(folder)
        except Exception as error:  # whatever the exporter raises: the robot learns and flies on
            self.failed += 1
            self.problem = f"{type(error).__name__}: {str(error).partition(chr(10))[0]}"
        else:
            self.written += 1

"""Learning from a stream in one pass: every frame is predicted, scored, then learned from."""

import time
from collections.abc import Iterator
from dataclasses import asdict, dataclass, replace
from itertools import islice
from pathlib import Path
from typing import Any

from safetensors import SafetensorError

from horizon_dl.config import Config
from horizon_dl.data.frame import Frame
from horizon_dl.data.source import FrameSource, Recording, calibrated
from horizon_dl.data.view import View, any_view
from horizon_dl.errors import FrameError, InputError
from horizon_dl.methods.names import NET
from horizon_dl.online.figures import OnlineFigures
from horizon_dl.online.guard import Distrust, StreamGuard
from horizon_dl.online.periodic_export import PeriodicExport
from horizon_dl.online.run_directory import KIND, RunDirectory
from horizon_dl.output import output_folder, write_json
from horizon_dl.progress import show_progress
from horizon_dl.runtime.ranged import ranges_of
from horizon_dl.runtime.signature import Signer
from horizon_dl.training.checkpoint import Snapshot
from horizon_dl.training.online.learner import OnlineLearner, mean_loss
from horizon_dl.training.predict import flight_rules, prediction_of
from horizon_dl.training.run_folder import Run, save_run
from horizon_dl.uncertainty.measures import Measures
from horizon_dl.visualization.sink import Sink

RATE_MEMORY = 0.9


@dataclass
class Seen:
    """A frame that was predicted.

    Attributes:
        index: place in the source, from 0.
        item: the frame, or why its image could not be read.
        view: at the working size; None where the image could not be read.
        not_learned: why it is not learned from, or None.
        predict_s: time the prediction took.
        learn_s: time learning from it took.
        loss: mean over its steps, nats, or None.
        settled: nothing more happens to it.
    """

    index: int
    item: Frame | FrameError
    view: View | None
    not_learned: str | None
    predict_s: float = 0.0
    learn_s: float = 0.0
    loss: float | None = None
    settled: bool = False


class OnlineRun:
    """One run over a stream, which goes on from the checkpoint in its folder if there is one.

    Args:
        source: where frames come from.
        config: must be that of the checkpoint.
        folder: of the run.
        max_frames: of the source, counted from its beginning.
        export_every_s: seconds between fresh model files; None: no files.
        sign: signs them; None: they are not signed.
        restart: throw an earlier run in the folder away.
        overwrite: the same, and take the folder over where it holds something else.
        progress: show a progress bar.

    Attributes:
        sink: takes what is predicted, or None.
        show_every: the sink gets one frame in so many.
        rate_hz: frames a second, of late.

    Raises:
        InputError: the folder cannot be written, or holds a checkpoint of something else.
    """

    def __init__(
        self,
        source: FrameSource,
        config: Config,
        folder: Path,
        *,
        max_frames: int | None = None,
        export_every_s: float | None = None,
        sign: Signer | None = None,
        restart: bool = False,
        overwrite: bool = False,
        progress: bool = False,
    ) -> None:
        self.source, self.config, self.folder = source, config, folder
        self.learner = OnlineLearner(config, config.seed)
        self.guard = StreamGuard(config.evidence)
        self.figures = OnlineFigures(config, source.headers if isinstance(source, Recording) else ())
        self.keeper = RunDirectory(folder, source, config, restart=restart, overwrite=overwrite)
        self.stopped = False
        self.sink: Sink | None = None
        self.show_every = 1
        self._max_frames = max_frames
        self._camera = calibrated(source)
        self._export = (
            None if export_every_s is None else PeriodicExport(folder, self._camera, export_every_s, sign)
        )
        if self.keeper.found is not None:
            self._restore(self.keeper.found)
        self.position = self.keeper.position
        if self.keeper.found is None:
            self.keeper.save_first(self._snapshot())
        self.keeper.found = None  # its tensors are in use or copied: a replay memory is not held twice
        total = source.length if max_frames is None else min(max_frames, source.length or max_frames)
        self._bar: Any = show_progress(
            what="online", total=total, initial=self.position, unit="frame", disable=not progress
        )
        self.rate_hz: float | None = None
        self._last_s = time.perf_counter()

    def items(self) -> Iterator[tuple[int, Frame | FrameError]]:
        """The frames that are left, with their places in the source."""
        left = None if self._max_frames is None else max(0, self._max_frames - self.position)
        return enumerate(islice(self.source.frames(self.position), left), self.position)

    def run(self) -> None:
        """Predict and learn from every frame that is left, as fast as it goes."""
        for index, item in self.items():
            seen = self.see(index, item)
            for _ in self.learning(seen):
                pass
            self.settle(seen)
            if self.keeper.due(self.position):
                self.save()
            if self.stopped:
                break

    def stop(self) -> None:
        """End after the frame at work; from any thread or a signal."""
        self.stopped = True

    def see(self, index: int, item: Frame | FrameError) -> Seen:
        """Predict a frame, score the prediction, and judge whether to learn from it."""
        self.figures.seen += 1
        if isinstance(item, FrameError):
            return Seen(index, item, None, Distrust.UNREADABLE)
        view = any_view(item, self.config.image.max_pixels)
        start = time.perf_counter()
        found = self.learner.predict(view)
        took_s = time.perf_counter() - start
        self.figures.timed(took_s)
        reason = self.guard.check(item)
        if reason is None or not reason.spoils_horizon:
            self.figures.predicted_frame(index, item, view, found, self.learner.single_pass)
        self._show(index, item, view, found)
        return Seen(index, item, view, reason, took_s)

    def learning(self, seen: Seen) -> Iterator[None]:
        """Learn from a frame if it can be trusted, one step at a time."""
        if seen.not_learned is not None or seen.view is None:
            return
        losses: list[float] = []
        steps = self.learner.steps(seen.view)
        while True:
            start = time.perf_counter()
            loss = next(steps, None)
            seen.learn_s += time.perf_counter() - start
            if loss is None:
                break
            losses.append(loss)
            yield
        self.figures.accumulator.train_s += seen.learn_s
        seen.loss = mean_loss(losses)

    def settle(self, seen: Seen) -> None:
        """Close a frame: count it, write its line, move the bar; frames are settled in their order."""
        seen.settled = True
        self.position = seen.index + 1
        self.figures.settled(seen.not_learned)
        now_s = time.perf_counter()
        rate = 1.0 / max(now_s - self._last_s, 1e-6)
        self.rate_hz = rate if self.rate_hz is None else RATE_MEMORY * self.rate_hz + (1 - RATE_MEMORY) * rate
        self._last_s = now_s
        line = self._line(seen)
        self.keeper.line(line, seen.index)
        shown = {"accuracy": line["horizon_accuracy"], "loss": line["loss"]}
        known = {name: f"{value:.3f}" for name, value in shown.items() if value is not None}
        self._bar.set_postfix(refresh=False, **known)
        self._bar.update()
        if self._export is not None and self.figures.learned:
            self._export.offer(lambda: self.learner.frozen(self._info()))

    def save(self) -> bool:
        """Write a checkpoint; every frame seen must be settled."""
        return self.keeper.save(self.position, self._snapshot())

    def finish(self, **more: Any) -> Run:
        """Write the last checkpoint and make the folder one that `evaluate`, `predict` and `export` take.

        Args:
            more: further entries of run.json.

        Raises:
            InputError: no frame could be learned from, or the folder cannot be written.
        """
        self._bar.close()
        self.save()
        self.keeper.close()
        if not self.figures.learned:
            reasons = ", ".join(f"{reason}: {n}" for reason, n in self.figures.reasons.items())
            problem = f"has no frame to learn from ({reasons or 'it is empty'})"
            raise InputError(self.source.name, problem, "see `horizon-dl check-data`")
        run = self.learner.frozen({**self._info(), **more})()
        if self._export is not None:
            self._export.wait()
        try:
            with output_folder(self.folder, KIND, adding=True) as folder:
                save_run(folder, run)
                metrics = self.figures.metrics(self.source.name)
                metrics["methods"][NET]["self_assessment"] = run.info["self_assessment"]
                write_json(folder / "metrics.json", metrics)
        except (OSError, SafetensorError) as error:
            problem = f"cannot be written ({getattr(error, 'strerror', None) or error})"
            raise InputError(self.folder, problem, "make room; the same command then goes on") from None
        self._close_sink()
        if self._export is not None:
            self._export.finish(run)
            if self._export.problem is not None:
                self.keeper.say(f"{self._export.failed} exports failed ({self._export.problem})")
        return run

    def _show(self, index: int, frame: Frame, view: View, found: Measures) -> None:
        """Hand a prediction to the sink; its trouble is no reason to stop learning."""
        if self.sink is None or index % self.show_every:
            return
        prediction = prediction_of(frame, view, found, self.figures.validation.thresholds[NET].compute())
        try:
            prediction = replace(prediction, rules=flight_rules(self.config))
            self.sink.log(frame, prediction, ranges_of(frame, prediction))
        except (OSError, ValueError, InputError) as error:
            self.keeper.say(f"nothing is shown any more ({error}); learning goes on")
            self.sink = None

    def _close_sink(self) -> None:
        try:
            if self.sink is not None:
                self.sink.close()
        except (OSError, ValueError, InputError) as error:
            self.keeper.say(f"film or page could not be finished ({error})")

    def _info(self) -> dict[str, Any]:
        return {
            "data": self.source.name,
            "format": self.source.format,
            "camera": asdict(self._camera),
            "frames": self.figures.learned,
            "online": {
                **self.figures.counts(),
                "dropped_steps": self.learner.dropped,
                "remembered": len(self.learner.memory),
                "checkpoints_failed": self.keeper.failed,
            },
            "train_s": self.figures.accumulator.train_s,
        }

    def _line(self, seen: Seen) -> dict[str, Any]:
        auc, within = self.figures.auc()
        return {
            "index": seen.index,
            "name": str(seen.item.args[0]) if isinstance(seen.item, FrameError) else seen.item.name,
            "time_s": None if isinstance(seen.item, FrameError) else finite(seen.item.time_s),
            "learned": seen.not_learned is None,
            "not_learned": seen.not_learned,
            "loss": finite(seen.loss),
            **self.figures.sides.compute(),
            "auc": auc,
            "auc_within_depression": within,
            "predict_ms": 1e3 * seen.predict_s,
            "learn_ms": 1e3 * seen.learn_s,
            "frames_per_s": self.rate_hz,
        }

    def _snapshot(self) -> Snapshot:
        return Snapshot.join(
            {
                "learner": self.learner.snapshot(),
                "guard": self.guard.snapshot(),
                "figures": self.figures.snapshot(),
            }
        )

    def _restore(self, snapshot: Snapshot) -> None:
        try:
            self.learner.restore(snapshot.part("learner"))
            self.guard.restore(snapshot.part("guard"))
            self.figures.restore(snapshot.part("figures"))
        except (KeyError, ValueError, TypeError, RuntimeError) as error:
            problem = f"holds a checkpoint that does not fit ({type(error).__name__})"
            raise InputError(self.folder, problem, "start anew with --restart") from None


def finite(number: float | None) -> float | None:
    """The number; None for NaN and infinities, which JSON does not know."""
    return number if number is not None and abs(number) < float("inf") else None

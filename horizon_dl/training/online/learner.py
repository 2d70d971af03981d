"""The online learner: frame in, prediction out, a few steps of learning, next frame."""

import copy
import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any, cast

import numpy as np
import torch
from numpy.typing import NDArray

from horizon_dl.config import Config
from horizon_dl.data.frame import Frame
from horizon_dl.data.view import View, any_view
from horizon_dl.geometry.resize import halved
from horizon_dl.models.encoded import EncodedImage
from horizon_dl.models.fcn import HorizonFCN
from horizon_dl.models.start import simulated_net, start_of, starting_net
from horizon_dl.training.averaging import averaged
from horizon_dl.training.checkpoint import Snapshot
from horizon_dl.training.context import share_of_deepest, taught_share
from horizon_dl.training.crops import Batch, draw_batch
from horizon_dl.training.evidence import training_evidence
from horizon_dl.training.half_resolution import (
    Teacher,
    doubled,
    guide_of,
    half_resolution_frame,
    half_resolution_target,
)
from horizon_dl.training.learning_state import learning_tensors, restore_learning
from horizon_dl.training.loss import horizon_loss
from horizon_dl.training.online.compression import CompressedFrame, unpack, unpack_elevation
from horizon_dl.training.online.replay_buffer import ReplayBuffer
from horizon_dl.training.online.running_agreement import ASK_EVERY, RunningAgreement
from horizon_dl.training.run_folder import Run
from horizon_dl.uncertainty.measures import Measures, binary_entropy
from horizon_dl.uncertainty.threshold import MOST_FRAMES, PaperThreshold, paper_threshold

Map = NDArray[np.float32]

# Picked on arena, corridor, hallway and KITTI with the rest of the recipe: expect less elsewhere.
NEWEST_CROPS = 1
"""Crops of the newest frame in every batch; the others come from the memory."""
FIRST_GUIDED_FRAME = 10
"""From this frame on the targets also follow what the net has learned."""
RENEWAL_FRAMES = 2
"""Then one old target is made anew every so many frames."""
UNGUIDED = -1
"""Older than any target that a net has guided."""


class OnlineLearner:
    """A net that learns from a stream, in one pass; the moving average of its weights predicts.

    How far net and paths agree decides the heads' shares of the prediction and the simulated worlds' net's
    share of the targets, see `RunningAgreement`.

    Frames, which carry image, camera and `up_cam`, may be given as they are. What should not be learned from
    (frozen pictures, an attitude that jumps) a `StreamGuard` finds.

    Attributes:
        frames: learned from so far.
        dropped: steps that were not taken because their loss or gradient was not finite.
        memory: what is replayed.

    Example:
        >>> learner, guard = OnlineLearner(Config()), StreamGuard()    # doctest: +SKIP
        >>> for frame in camera:                                       # doctest: +SKIP
        ...     avoid(learner.predict(frame).entropy)
        ...     if guard.check(frame) is None:
        ...         learner.learn(frame)
    """

    def __init__(self, config: Config, seed: int = 0) -> None:
        self.config = config
        self.frames = 0
        self.dropped = 0
        self._taken = 0
        self._seen: tuple[Frame, View] | None = None
        self._last: tuple[NDArray[np.uint8], int, EncodedImage] | None = None
        self._rng = np.random.default_rng(seed)
        with torch.random.fork_rng(devices=[]):
            torch.manual_seed(seed)
            self._net = starting_net(config.model)
            self._dropout_state = torch.get_rng_state()
        self._average = averaged(self._net, config.train.average_decay)
        self.memory = ReplayBuffer(config.online.memory_mb, self._rng)
        self._agreement = RunningAgreement(config.geodesic)
        self._teacher: Teacher | None = None
        self._simulated = guide_of(simulated_net()) if taught_share(config, 0.0) else None
        self._optimiser = torch.optim.AdamW(
            self._net.parameters(), lr=config.online.learning_rate, weight_decay=config.train.weight_decay
        )

    @property
    def net(self) -> HorizonFCN:
        """The net that predicts."""
        return cast(HorizonFCN, self._average.module)

    def predict(self, seen: View | Frame) -> Measures:
        """`p_above` and all uncertainties of a frame, (h, w) at the working size; see `Measures`.

        A frame without attitude is predicted, too; its surprisal means nothing.
        """
        view = self._view(seen)
        return self._encoded(view.image).measures(view.elevation > 0)

    def p_above_samples(self, view: View) -> Map:
        """`p_above` under each dropout mask, (samples, h, w) in [0, 1]."""
        return self._encoded(view.image).samples()

    def single_pass(self, view: View) -> Map:
        """`p_above` without dropout, (1, h, w) in [0, 1]."""
        return self._encoded(view.image).single_pass()

    def learn(self, seen: View | Frame) -> float:
        """Learn from a frame and from remembered ones.

        Returns:
            the mean loss over the steps, nats; NaN where nothing could be learned: the frame has no pixel
            with a label, or no step had a finite loss.
        """
        return mean_loss(list(self.steps(seen)))

    def steps(self, seen: View | Frame) -> Iterator[float]:
        """The same, one step whenever the next loss (NaN: step dropped) is asked for.

        So a prediction that is urgent can come between two steps. No checkpoint may.
        """
        view = self._view(seen)
        guide = self._guide if self.frames >= FIRST_GUIDED_FRAME else None
        if guide is not None and self.frames % ASK_EVERY == 0:
            self._follow(self._agreement.ask(view, self._encoded(view.image).of_all_depths()))
        newest = half_resolution_frame(view, self.config, guide, self._teacher)
        if not newest.valid_mask.any():
            return
        self.memory.add(newest, halved(view.elevation), UNGUIDED if guide is None else self.frames)
        if guide is not None and self.frames % RENEWAL_FRAMES == 0:
            # Other images than the newest: what was asked of that stays at hand.
            anew, teacher = guide_of(self.net), self._teacher
            self.memory.renew(
                self.frames,
                lambda image, up: half_resolution_target(image, up, self.config, anew, teacher),
            )
        settings = self.config.online
        early = self.frames < settings.warm_up_frames
        self.frames += 1
        # Unpacked once a frame, not once a step: each step takes other crops of them.
        replayed = self.memory.draw(settings.batch - NEWEST_CROPS)
        for _ in range(settings.warm_up_steps if early else settings.steps_per_frame):
            yield self._step(draw_batch([newest] * NEWEST_CROPS + replayed, settings.crop, self._rng))

    def frozen(self, info: dict[str, Any]) -> Callable[[], Run]:
        """What the learner is now, as a run that is ready to be saved or exported.

        This copies; the threshold is found when the result is called, in another thread if need be.

        Args:
            info: for the run's `info`, which the threshold is added to.
        """
        net, frames = copy.deepcopy(self.net).eval(), self.memory.sample(MOST_FRAMES)
        rule = {
            "start": start_of(self.config.model),
            "threshold_rule": PaperThreshold(self.config.threshold.percentile).rule,
        }

        def run() -> Run:
            threshold = remembered_threshold(net, frames, self.config)
            remembered = ((unpack(frame).image, unpack_elevation(frame)) for frame in frames)
            views = (View(image, doubled(half, image.shape[:2])) for image, half in remembered)
            evidence = training_evidence(net, views, self.config)
            return Run(net, self.config, {**info, "threshold": threshold, **evidence, **rule})

        return run

    def snapshot(self) -> Snapshot:
        """All that is needed to go on; tensors are shared, not copied."""
        own = learning_tensors(self._net, self._average, self._optimiser, self._dropout_state)
        values = {
            "frames": self.frames,
            "dropped": self.dropped,
            "taken": self._taken,
            "random": self._rng.bit_generator.state,
            "agreements": self._agreement.state(),
            "optimiser": self._optimiser.state_dict()["param_groups"],
        }
        return Snapshot.join({"learner": Snapshot(own, values), "memory": self.memory.snapshot()})

    def restore(self, snapshot: Snapshot) -> None:
        """Go on from a snapshot of a learner with the same configuration."""
        own = snapshot.part("learner")
        self._seen = self._last = None
        groups = own.values["optimiser"]
        restore_learning(own.tensors, groups, self._net, self._average, self._optimiser)
        self._dropout_state = own.tensors["dropout"]
        self._rng.bit_generator.state = own.values["random"]
        self.frames, self.dropped, self._taken = (own.values[name] for name in ("frames", "dropped", "taken"))
        self.memory.restore(snapshot.part("memory"))
        self._agreement.load(own.values["agreements"])
        self._follow(self._agreement.mean())

    def _view(self, seen: View | Frame) -> View:
        if isinstance(seen, View):
            return seen
        if self._seen is None or self._seen[0] is not seen:
            self._seen = (seen, any_view(seen, self.config.image.max_pixels))
        return self._seen[1]

    def _encoded(self, image: NDArray[np.uint8]) -> EncodedImage:
        """One pass of the encoder serves all that is asked of an image until the next step."""
        last = self._last
        if last is None or last[0] is not image or last[1] != self._taken:
            self._last = last = (image, self._taken, EncodedImage(self.net, image))
        return last[2]

    def _guide(self, image: NDArray[np.uint8], size: tuple[int, ...]) -> Map:
        return self._encoded(image).of_all_depths(size)

    def _follow(self, agreement: float | None) -> None:
        """Let the prediction and the targets follow how far net and paths agree."""
        if agreement is None:
            return
        deepest = share_of_deepest(agreement)
        for net in (self._net, self.net):
            net.weigh_deepest(deepest)
        share = taught_share(self.config, deepest)
        self._teacher = Teacher(self._simulated, share) if self._simulated and share else None

    def _learning_rate(self) -> float:
        """High at first, then as one over the number of steps, to a floor."""
        settings = self.config.online
        return max(
            settings.least_rate, settings.learning_rate / (1.0 + self._taken / settings.half_rate_steps)
        )

    def _step(self, batch: Batch) -> float:
        """One step, or NaN and everything as before: batch statistics change already in the forward pass."""
        for group in self._optimiser.param_groups:
            group["lr"] = self._learning_rate()
        self._net.train()
        statistics = [buffer.clone() for buffer in self._net.buffers()]
        with self._own_dropout():
            loss = horizon_loss(self._net(batch.images), batch)
        self._optimiser.zero_grad()
        loss.backward()  # type: ignore[no-untyped-call]
        norm = torch.nn.utils.clip_grad_norm_(self._net.parameters(), 1.0)
        if not (math.isfinite(loss.item()) and math.isfinite(norm.item())):
            self.dropped += 1
            for buffer, before in zip(self._net.buffers(), statistics, strict=True):
                buffer.copy_(before)
            return math.nan
        self._optimiser.step()
        self._taken += 1
        self._average.update_parameters(self._net)
        return loss.item()

    @contextmanager
    def _own_dropout(self) -> Iterator[None]:
        """Dropout draws from the learner's own random numbers and leaves those of the program alone."""
        with torch.random.fork_rng(devices=[]):
            torch.set_rng_state(self._dropout_state)
            yield
            self._dropout_state = torch.get_rng_state()


def remembered_threshold(net: HorizonFCN, frames: Sequence[CompressedFrame], config: Config) -> float:
    """The paper's threshold, bits: a percentile of a net's entropies on remembered frames."""
    entropies = (
        (binary_entropy(EncodedImage(net, frame.image).p_above()), frame.valid_mask)
        for frame in map(unpack, frames)
    )
    return paper_threshold(entropies, config.threshold.percentile)


def mean_loss(losses: list[float]) -> float:
    """Mean of the finite ones, NaN if there is none."""
    finite = [loss for loss in losses if math.isfinite(loss)]
    return sum(finite) / len(finite) if finite else math.nan

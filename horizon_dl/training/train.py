"""Offline training on a recording."""

import copy
import time
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path
from typing import Any, cast

import lightning
import numpy as np
import torch
from lightning.pytorch.loggers import Logger
from torch.utils.data import DataLoader

from horizon_dl.config import Config, TrainerConfig
from horizon_dl.data.evenly import evenly
from horizon_dl.data.source import Recording
from horizon_dl.data.view import View
from horizon_dl.models.fcn import HorizonFCN
from horizon_dl.models.start import simulated_net, start_of, starting_net
from horizon_dl.progress import show_progress
from horizon_dl.quiet import quiet_logger
from horizon_dl.training.context import RoundPlan, agreement_of, all_depths, before_last_round
from horizon_dl.training.crops import TrainingFrame
from horizon_dl.training.distributed import SyncBatchNorm
from horizon_dl.training.evidence import EVIDENCE_FRAMES, training_evidence
from horizon_dl.training.frame_store import FramePool, FrameStore
from horizon_dl.training.half_resolution import Teacher, guide_of, half_resolution_frame
from horizon_dl.training.learning_state import starting
from horizon_dl.training.loggers import open_logger
from horizon_dl.training.module import CropStream, HorizonModule
from horizon_dl.training.resumable import RoundState, TrainingKeeper
from horizon_dl.training.run_folder import Run
from horizon_dl.training.several_processes import process_number, processes_of
from horizon_dl.training.thresholds import paper_threshold_of
from horizon_dl.uncertainty.threshold import PaperThreshold

AfterRound = Callable[[HorizonFCN, FrameStore, int, Logger], None]
"""Takes the net after a round, its frames, the steps taken so far, and the logger."""


def train_net(
    store: FrameStore,
    indices: Sequence[int],
    *,
    seed: int,
    log_dir: Path | None = None,
    progress: bool = False,
    keeper: TrainingKeeper | None = None,
    after_round: AfterRound | None = None,
) -> HorizonFCN:
    """A net trained on frames of a recording, in rounds.

    The targets of the first round follow the edges of the images alone; those of every further round also
    what the net has learned so far, its edges and where it is surest. What it took for one surface in most
    frames then is one in the frames where shade or a reflection cuts it. Before the last round is decided
    whether it learns from context, and how far its targets follow the simulated worlds' net; see `context`.

    Args:
        store: where the frames come from.
        indices: which of them.
        seed: of crops and dropout, and of weights that start at random; the same seed on the same machine
            gives the same net.
        log_dir: folder that the config's logger writes to, or None.
        progress: show progress bars.
        keeper: writes checkpoints, and knows whether to go on from one; None: none are written.
        after_round: is told the net after each round, and the logger where there is one.

    Raises:
        InputError: too many of the frames cannot be used.
        TrainingStopped: the keeper was asked to stop.
    """
    config: Config = store.config
    if processes_of(config.trainer) > 1:
        keeper = None  # a checkpoint would have to hold the random numbers of all of them
    rng = np.random.default_rng(seed)
    logger = open_logger(config.logger, log_dir) if log_dir else None
    found = None if keeper is None else keeper.found
    with _quiet_lightning(), torch.random.fork_rng(devices=[]):
        torch.manual_seed(seed)
        net = starting_net(config.model)
        if found is not None:
            _restore(found, net, rng, store)
        for number in range(found.number if found else 0, len(config.train.rounds)):
            within = found if found is not None and found.step and found.number == number else None
            net = _train_round(
                store, indices, net, number, rng, within, logger=logger, progress=progress, keeper=keeper
            )
            if logger is not None and after_round is not None and process_number() == 0:
                after_round(net, store, sum(config.train.rounds[: number + 1]), logger)
                logger.finalize("success")  # writes what was said after Lightning's own end
            if keeper is not None:
                keeper.save(_between_rounds(number + 1, net, rng, store))
                keeper.check_stop()
    return net


def _train_round(
    store: FrameStore,
    indices: Sequence[int],
    net: HorizonFCN,
    number: int,
    rng: np.random.Generator,
    within: RoundState | None,
    *,
    logger: Logger | None,
    progress: bool,
    keeper: TrainingKeeper | None,
) -> HorizonFCN:
    config, steps = store.config, store.config.train.rounds[number]
    title = f"round {number + 1} of {len(config.train.rounds)}"
    # A copy: targets that are made while the net is trained are those of the round's beginning.
    guide = copy.deepcopy(net).eval() if number else None
    last = number == len(config.train.rounds) - 1
    plan = before_last_round(net, store, indices) if last else RoundPlan(config.train)
    pool = FramePool(
        store,
        indices,
        make_frame=_frame_maker(config, guide, plan.taught, keeper),
        most=plan.frames(steps, processes_of(config.trainer)),
        memory_mb=config.train.memory_mb,
        rng=rng,
        progress=progress,
        title=title,
        held=within.values["held"] if within else None,
    )
    if within is not None:
        rng.bit_generator.state = within.values["random"]
    stream = CropStream(pool, plan.settings, rng)
    first = within.step if within else 0

    def after_step(module: HorizonModule) -> None:
        if keeper is None or module.taken == steps or not keeper.due():
            return
        tensors, values = module.snapshot()
        if guide is not None:
            tensors |= {f"guide.{name}": tensor for name, tensor in guide.state_dict().items()}
        random = stream.random_state(module.taken - first)
        values |= {"random": random, "held": pool.held, "frames": store.state()}
        keeper.save(RoundState(number, module.taken, tensors, values))
        module.trainer.should_stop = keeper.stopped

    # Later rounds keep the first one's batch statistics, and drop nothing: see docs/RESEARCH.md.
    module = HorizonModule(
        net.train(number == 0),
        plan.settings,
        steps,
        done=sum(config.train.rounds[:number]),
        after_step=after_step,
        going_on=within,
    )
    try:
        crops = DataLoader(stream, batch_size=None)
        _trainer(config.trainer, steps - first, logger, title if progress else None).fit(module, crops)
    except SystemExit:  # Lightning's way to say that a signal came
        if keeper is None or not keeper.stopped:
            raise KeyboardInterrupt from None
    if keeper is not None and module.taken < steps:
        keeper.check_stop()
    return cast(HorizonFCN, module.average.module).cpu().eval()


def _frame_maker(
    config: Config, guide: HorizonFCN | None, taught: float, keeper: TrainingKeeper | None
) -> Callable[[View], TrainingFrame]:
    guided = None if guide is None else guide_of(guide)
    teacher = Teacher(guide_of(simulated_net()), taught) if taught else None

    def make(view: View) -> TrainingFrame:
        if keeper is not None:
            keeper.check_stop()  # what was learned stands in the last checkpoint
        return half_resolution_frame(view, config, guided, teacher)

    return make


def _between_rounds(number: int, net: HorizonFCN, rng: np.random.Generator, store: FrameStore) -> RoundState:
    """What a round begins with."""
    tensors = {f"net.{name}": tensor for name, tensor in net.state_dict().items()}
    values = {"random": rng.bit_generator.state, "frames": store.state()}
    return RoundState(number, 0, {**tensors, "dropout": torch.get_rng_state()}, values)


def _restore(found: RoundState, net: HorizonFCN, rng: np.random.Generator, store: FrameStore) -> None:
    """Net (within a later round: its guide), random numbers and skipped frames of a state."""
    net.load_state_dict(starting(found.tensors, "guide.") or starting(found.tensors, "net."))
    rng.bit_generator.state = found.values["random"]
    torch.set_rng_state(found.tensors["dropout"])
    store.restore(found.values["frames"])
    net.eval()


def _trainer(
    settings: TrainerConfig, steps: int, logger: Logger | None, title: str | None
) -> lightning.Trainer:
    return lightning.Trainer(
        **settings.model_dump(),
        max_steps=steps,
        plugins=[SyncBatchNorm()],
        logger=logger or False,
        log_every_n_steps=10,
        enable_progress_bar=False,
        callbacks=[] if title is None else [StepBar(title)],
        enable_model_summary=False,
        enable_checkpointing=False,
        gradient_clip_val=1.0,
    )


class StepBar(lightning.Callback):
    """A progress bar over training steps, on standard error as all the others."""

    def __init__(self, title: str) -> None:
        self._title = title

    def on_train_start(self, trainer: lightning.Trainer, _: lightning.LightningModule) -> None:
        """Open the bar."""
        self._bar: Any = show_progress(what=f"{self._title}, training", total=trainer.max_steps, unit="step")

    def on_train_batch_end(self, trainer: lightning.Trainer, *_: Any) -> None:
        """One step on, with the loss of this step."""
        self._bar.set_postfix(loss=f"{trainer.callback_metrics['loss']:.3f}", refresh=False)
        self._bar.update()

    def on_train_end(self, *_: Any) -> None:
        """Close the bar."""
        self._bar.close()


def train_run(
    recording: Recording,
    config: Config,
    *,
    log_dir: Path | None = None,
    progress: bool = False,
    keeper: TrainingKeeper | None = None,
    after_round: AfterRound | None = None,
) -> Run:
    """Train on a recording and choose the threshold; the result is ready to be saved.

    See `train_net` for the arguments.
    """
    store = FrameStore(recording, config)
    indices = range(recording.length)
    start = time.perf_counter()
    net = train_net(
        store,
        indices,
        seed=config.seed,
        log_dir=log_dir,
        progress=progress,
        keeper=keeper,
        after_round=after_round,
    )
    train_s = time.perf_counter() - start if keeper is None else keeper.train_s
    return finished_run(net, store, len(store.learned), train_s)


def finished_run(net: HorizonFCN, store: FrameStore, frames: int, train_s: float) -> Run:
    """A net trained on a recording, with its threshold and what is known of its training.

    Args:
        net: trained.
        store: of the recording.
        frames: how many of it the net learned from.
        train_s: how long that took.
    """
    recording, config = store.recording, store.config
    indices = range(recording.length)
    # Both read frames, and may find some that cannot be used.
    threshold, evidence = paper_threshold_of(net, store, indices), evidence_of(net, store, indices)
    info = {
        "data": recording.name,
        "format": recording.format,
        "camera": asdict(recording.calibrated),
        "frames": frames,
        "skipped": store.skipped,
        "start": start_of(config.model),
        "train_s": train_s,
        "threshold": threshold,
        "threshold_rule": PaperThreshold(config.threshold.percentile).rule,
        **evidence,
    }
    return Run(net.eval(), config, info)


def evidence_of(net: HorizonFCN, store: FrameStore, indices: Sequence[int]) -> dict[str, Any]:
    """See `training_evidence`, over at most 100 of the frames; and `path_agreement`, of 16 of them."""
    evidence = training_evidence(net, store.views(evenly(indices, EVIDENCE_FRAMES)), store.config)
    return {**evidence, "path_agreement": agreement_of(all_depths(net), store, indices)}


@contextmanager
def _quiet_lightning() -> Iterator[None]:
    """Without Lightning's advertisements and its advice on worker processes."""
    with quiet_logger("lightning.pytorch"), warnings.catch_warnings():
        warnings.filterwarnings("ignore", module="lightning.*")
        warnings.filterwarnings("ignore", message=".*(num_workers|IterableDataset|epoch).*")
        yield

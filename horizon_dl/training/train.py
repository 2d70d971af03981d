"""Offline training on a recording."""

import logging
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
from lightning.pytorch.loggers import TensorBoardLogger
from torch.utils.data import DataLoader
from tqdm import tqdm

from horizon_dl.config import Config, TrainerConfig
from horizon_dl.data.source import Recording
from horizon_dl.data.view import View
from horizon_dl.models.build import build_net
from horizon_dl.models.dropout import p_above_of_all_depths, sample_p_above
from horizon_dl.models.fcn import HorizonFCN
from horizon_dl.training.crops import TrainingFrame, training_frame
from horizon_dl.training.distributed import SyncBatchNorm
from horizon_dl.training.evidence import EVIDENCE_FRAMES, evidence_card
from horizon_dl.training.frame_store import FramePool, FrameStore
from horizon_dl.training.module import CropStream, HorizonModule
from horizon_dl.training.run_folder import Run
from horizon_dl.uncertainty.measures import binary_entropy
from horizon_dl.uncertainty.percentile import stream_percentile

THRESHOLD_FRAMES = 50


def train_net(
    store: FrameStore,
    indices: Sequence[int],
    *,
    seed: int,
    log_dir: Path | None = None,
    progress: bool = False,
) -> HorizonFCN:
    """A net trained on frames of a recording, in rounds.

    The targets of the first round follow the edges of the images alone; those of every further round also
    what the net has learned so far, its edges and where it is surest. What it took for one surface in most
    frames then is one in the frames where shade or a reflection cuts it.

    Args:
        store: where the frames come from.
        indices: which of them.
        seed: of weights, crops and dropout; the same seed on the same machine gives the same net.
        log_dir: folder for TensorBoard logs, or None.
        progress: show progress bars.

    Raises:
        InputError: too many of the frames cannot be used.
    """
    config: Config = store.config
    rng = np.random.default_rng(seed)
    with _quiet_lightning(), torch.random.fork_rng(devices=[]):
        torch.manual_seed(seed)
        net = build_net(config.model)
        for number, steps in enumerate(config.train.rounds):
            pool = FramePool(
                store,
                indices,
                make_frame=_frame_maker(config, net if number else None),
                memory_mb=config.train.memory_mb,
                rng=rng,
                progress=progress,
            )
            crops = DataLoader(CropStream(pool, config.train, rng), batch_size=None)
            logger = TensorBoardLogger(log_dir, name="", version=f"round_{number}") if log_dir else None
            # Later rounds keep the first one's batch statistics, and drop nothing: see docs/RESEARCH.md.
            module = HorizonModule(net.train(number == 0), config.train, steps)
            _trainer(config.trainer, steps, logger, progress).fit(module, crops)
            net = cast(HorizonFCN, module.average.module).cpu().eval()
    return net


def _frame_maker(config: Config, net: HorizonFCN | None) -> Callable[[View], TrainingFrame]:
    if net is None:
        return lambda view: training_frame(view, config)
    return lambda view: training_frame(view, config, p_above_of_all_depths(net, view.image))


def _trainer(
    settings: TrainerConfig, steps: int, logger: TensorBoardLogger | None, progress: bool
) -> lightning.Trainer:
    return lightning.Trainer(
        **settings.model_dump(),
        max_steps=steps,
        plugins=[SyncBatchNorm()],
        logger=logger or False,
        log_every_n_steps=10,
        enable_progress_bar=False,
        callbacks=[StepBar()] if progress else [],
        enable_model_summary=False,
        enable_checkpointing=False,
        gradient_clip_val=1.0,
    )


class StepBar(lightning.Callback):
    """A progress bar over training steps, on standard error as all the others."""

    def on_train_start(self, trainer: lightning.Trainer, _: lightning.LightningModule) -> None:
        """Open the bar."""
        self._bar = tqdm(total=trainer.max_steps, desc="train", unit="step")

    def on_train_batch_end(self, trainer: lightning.Trainer, *_: Any) -> None:
        """One step on, with the loss of this step."""
        self._bar.set_postfix(loss=f"{trainer.callback_metrics['loss']:.3f}", refresh=False)
        self._bar.update()

    def on_train_end(self, *_: Any) -> None:
        """Close the bar."""
        self._bar.close()


def train_run(
    recording: Recording, config: Config, *, log_dir: Path | None = None, progress: bool = False
) -> Run:
    """Train on all frames of a recording and choose the threshold; the result is ready to be saved."""
    store = FrameStore(recording, config)
    indices = range(recording.length)
    start = time.perf_counter()
    net = train_net(store, indices, seed=config.seed, log_dir=log_dir, progress=progress)
    return finished_run(net, store, time.perf_counter() - start)


def finished_run(net: HorizonFCN, store: FrameStore, train_s: float) -> Run:
    """A net trained on all frames of a recording, with its threshold and what is known of its training."""
    recording, config = store.recording, store.config
    indices = range(recording.length)
    info = {
        "data": recording.name,
        "format": recording.format,
        "camera": asdict(recording.calibrated),
        "frames": len(indices) - len(store.skipped),
        "skipped": store.skipped,
        "train_s": train_s,
        "threshold": entropy_threshold(net, store, indices),
        "threshold_rule": f"percentile-{config.threshold.percentile:g}",
        "evidence": evidence_card(
            net, ((view.image, view.elevation) for view in store.views(evenly(indices, EVIDENCE_FRAMES)))
        ),
    }
    return Run(net.eval(), config, info)


def entropy_threshold(net: HorizonFCN, store: FrameStore, indices: Sequence[int]) -> float:
    """The paper's threshold, bits: a percentile of the entropies of at most 50 training frames."""
    config = store.config
    entropies = (
        binary_entropy(sample_p_above(net, view.image).mean(axis=0))[~np.isnan(view.elevation)]
        for view in store.views(evenly(indices, THRESHOLD_FRAMES))
    )
    return stream_percentile(entropies, config.threshold.percentile)


def evenly(indices: Sequence[int], count: int) -> list[int]:
    """At most `count` of the indices, evenly spread.

    Example:
        >>> evenly(range(100), 3)
        [0, 49, 99]
    """
    chosen = np.linspace(0, len(indices) - 1, min(count, len(indices))).astype(int)
    return [indices[i] for i in chosen]


@contextmanager
def _quiet_lightning() -> Iterator[None]:
    """Without Lightning's advertisements and its advice on worker processes."""
    logger = logging.getLogger("lightning.pytorch")
    level = logger.level
    logger.setLevel(logging.ERROR)
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", module="lightning.*")
        warnings.filterwarnings("ignore", message=".*(num_workers|IterableDataset|epoch).*")
        yield
    logger.setLevel(level)

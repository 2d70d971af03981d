"""A accumulator as a snapshot: histograms are mostly empty, so only what they hold is kept."""

from dataclasses import asdict
from typing import Any

import numpy as np
import torch

from horizon_dl.metrics.accumulators import Confusion, MethodAccumulator
from horizon_dl.metrics.ranging import joined
from horizon_dl.metrics.ranging_block import RangingBlock
from horizon_dl.metrics.roc import RocAccumulator
from horizon_dl.training.checkpoint import Snapshot
from horizon_dl.uncertainty.threshold import PaperThreshold

SCALARS = ("threshold", "right_sides", "sides", "frames", "predict_s", "train_s")
BELOW = ""
"""In place of the name of other pixels: the pixels below the horizon, which every accumulator has."""


def accumulator_snapshot(accumulator: MethodAccumulator) -> Snapshot:
    """All that a accumulator has gathered."""
    rocs = {BELOW: accumulator.rocs, **accumulator.other_rocs}
    parts = {
        f"{other}.{name}": roc_snapshot(roc)
        for other, by_score in rocs.items()
        for name, roc in by_score.items()
    }
    calibration = {name: torch.from_numpy(array) for name, array in vars(accumulator.calibration).items()}
    values: dict[str, Any] = {name: getattr(accumulator, name) for name in SCALARS}
    values |= {"raw": asdict(accumulator.raw), "filtered": asdict(accumulator.filtered), "rocs": list(parts)}
    return Snapshot.join({**parts, "accumulator": Snapshot(calibration, values)})


def restored_accumulator(snapshot: Snapshot) -> MethodAccumulator:
    """The accumulator of a snapshot."""
    own = snapshot.part("accumulator")
    accumulator = MethodAccumulator(
        raw=Confusion(**own.values["raw"]),
        filtered=Confusion(**own.values["filtered"]),
        **{name: own.values[name] for name in SCALARS},
    )
    for name in vars(accumulator.calibration):
        setattr(accumulator.calibration, name, own.tensors[name].numpy().copy())
    for key in own.values["rocs"]:
        other, _, name = key.partition(".")
        by_score = accumulator.rocs if other == BELOW else accumulator.other_rocs.setdefault(other, {})
        by_score[name] = restored_roc(snapshot.part(key))
    return accumulator


def ranging_snapshot(block: RangingBlock) -> Snapshot:
    """All that a ranging block has gathered."""
    return Snapshot.join(
        {
            name: Snapshot(
                {
                    "relative": torch.from_numpy(joined(accumulator.relative).astype(np.float32)),
                    "within_2sd": torch.from_numpy(joined(accumulator.within_2sd).astype(np.bool_)),
                    "counts": torch.from_numpy(accumulator.counts.copy()),
                }
            )
            for name, accumulator in block.accumulators.items()
        }
    )


def restore_ranging(block: RangingBlock, snapshot: Snapshot) -> None:
    """Go on from a snapshot of a block of the same recording."""
    for name, accumulator in block.accumulators.items():
        found = {key: tensor.numpy().copy() for key, tensor in snapshot.part(name).tensors.items()}
        accumulator.relative, accumulator.within_2sd, accumulator.counts = (
            [found["relative"]],
            [found["within_2sd"]],
            found["counts"],
        )


def roc_snapshot(roc: RocAccumulator) -> Snapshot:
    """The places of a histogram that hold anything, and how much."""
    counts = roc.counts.ravel()
    places = np.flatnonzero(counts)
    return Snapshot(
        {
            "places": torch.from_numpy(places.astype(np.int32)),
            "counts": torch.from_numpy(counts[places]),
        }
    )


def restored_roc(snapshot: Snapshot) -> RocAccumulator:
    """The histogram of a snapshot."""
    roc = RocAccumulator()
    roc.counts.ravel()[snapshot.tensors["places"].numpy()] = snapshot.tensors["counts"].numpy()
    return roc


def threshold_snapshot(threshold: PaperThreshold) -> Snapshot:
    """The scores counted so far."""
    return Snapshot({"counts": torch.from_numpy(threshold.counts)})


def restore_threshold(threshold: PaperThreshold, snapshot: Snapshot) -> None:
    """The scores of a snapshot in place of those counted."""
    threshold.counts[:] = snapshot.tensors["counts"].numpy()

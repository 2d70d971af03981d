"""Run folders: a trained net with all that is needed to use it again."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from safetensors import SafetensorError
from safetensors.torch import load_file, save_file
from torch import Tensor

from horizon_dl.config import Config, load_config, save_config
from horizon_dl.errors import InputError
from horizon_dl.models.build import build_net
from horizon_dl.models.fcn import HorizonFCN
from horizon_dl.output import write_json
from horizon_dl.provenance import machine, versions

WEIGHTS, CONFIG, INFO = "weights.safetensors", "config.yaml", "run.json"


@dataclass(frozen=True)
class Run:
    """A trained net.

    Attributes:
        net: in evaluation mode.
        config: the resolved configuration it was trained with.
        info: what is written to `run.json`: the data, the frames used, the threshold, figures.
    """

    net: HorizonFCN
    config: Config
    info: dict[str, Any]

    @property
    def threshold(self) -> float:
        """Entropy above which a pixel counts as obstacle, bits."""
        return float(self.info["threshold"])


def weights(net: HorizonFCN) -> dict[str, Tensor]:
    """All weights and batch statistics by name, in the order of memory that a file needs."""
    return {name: tensor.contiguous() for name, tensor in net.state_dict().items()}


def save_run(folder: Path, run: Run) -> None:
    """Write weights, config and info (with versions and machine) into an existing folder."""
    save_file(weights(run.net), folder / WEIGHTS)
    save_config(run.config, folder / CONFIG)
    write_json(folder / INFO, {**run.info, "versions": versions(), "machine": machine()})


def load_run(folder: Path) -> Run:
    """Read a run folder.

    Raises:
        InputError: a file is missing, truncated, or does not fit the others.
    """
    for name in (WEIGHTS, CONFIG, INFO):
        if not (folder / name).is_file():
            raise InputError(folder, f"is no run folder: it lacks {name}", "give what `train --out` wrote")
    config = load_config(folder / CONFIG)
    net = build_net(config.model)
    try:
        net.load_state_dict(load_file(folder / WEIGHTS))
    except (SafetensorError, RuntimeError) as error:
        problem = f"does not fit the config ({str(error).splitlines()[0]})"
        raise InputError(folder / WEIGHTS, problem, "train again") from None
    try:
        info = json.loads((folder / INFO).read_text())
        float(info["threshold"])
    except (ValueError, KeyError, TypeError):
        raise InputError(folder / INFO, "is damaged", "train again") from None
    return Run(net.eval(), config, info)

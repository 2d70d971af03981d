"""Run folders: a trained net with all that is needed to use it again."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from safetensors import SafetensorError
from safetensors.torch import load_file, save_file
from torch import Tensor

from horizon_dl.config import Config, load_config, save_config
from horizon_dl.errors import InputError, shortened
from horizon_dl.evidence.place import Place
from horizon_dl.models.build import build_net
from horizon_dl.models.fcn import HorizonFCN
from horizon_dl.output.files import system_error, write_json
from horizon_dl.output.manifest import Manifest, check_files, file_hash, write_manifest
from horizon_dl.provenance import machine, versions
from horizon_dl.schemas.run import RunInfo
from horizon_dl.training.evidence import place_of
from horizon_dl.training.run_files import CONFIG, FILES, INFO, WEIGHTS, check_run_folder

TRAIN_AGAIN = "train again"


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

    @property
    def place(self) -> Place | None:
        """Limits for its evidence; None for a run of before they were kept."""
        return place_of(self.info, INFO)


def weights(net: HorizonFCN) -> dict[str, Tensor]:
    """All weights and batch statistics by name, in the order of memory that a file needs."""
    return {name: tensor.contiguous() for name, tensor in net.state_dict().items()}


def save_run(folder: Path, run: Run) -> None:
    """Write weights, config and info (with versions and machine) into an existing folder, and their hashes.

    Raises:
        OSError: the disk is full, read-only, or gone.
    """
    try:
        save_file(weights(run.net), folder / WEIGHTS)
    except SafetensorError as error:
        raise system_error(error) from None
    save_config(run.config, folder / CONFIG)
    write_json(folder / INFO, {"schema": 1, **run.info, "versions": versions(), "machine": machine()})
    write_manifest(folder, Manifest("run", {name: file_hash(folder / name) for name in FILES}))


def load_run(folder: Path) -> Run:
    """Read a run folder.

    Raises:
        InputError: a file is missing, damaged, or does not fit the others.
    """
    check_run_folder(folder)
    check_files(folder, FILES, TRAIN_AGAIN)
    config = load_config(folder / CONFIG)
    net = build_net(config.model)
    try:
        net.load_state_dict(load_file(folder / WEIGHTS))
    except (SafetensorError, RuntimeError, OSError, ValueError) as error:
        problem = (
            f"does not fit the config or is of another version ({shortened(' '.join(str(error).split()))})"
        )
        raise InputError(folder / WEIGHTS, problem, TRAIN_AGAIN) from None
    return Run(net.eval(), config, read_info(folder))


def read_info(folder: Path) -> dict[str, Any]:
    """What `run.json` says, with a threshold that can be used.

    Raises:
        InputError: it is no JSON, of another version, or lacks a key.
    """
    RunInfo.read(folder / INFO)
    info: dict[str, Any] = json.loads((folder / INFO).read_text())
    return info

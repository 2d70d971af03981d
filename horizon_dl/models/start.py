"""What a net starts from: weights that the small net learned in simulated worlds, or random ones."""

from pathlib import Path

import torch
from safetensors.torch import load_file

from horizon_dl.config import ModelConfig
from horizon_dl.models.build import build_net
from horizon_dl.models.fcn import HorizonFCN

SIMULATED = Path(__file__).with_name("simulated_start.safetensors")
"""Weights and batch statistics of the small net, written by `benchmarks/simulated_start.py`.

The net was taught floor against everything else in rendered rooms, hallways, yards and streets, whose labels
come from the renderer: no picture of a real camera and no label by hand took part.
"""

OWN = ("masks", "head_weights")
"""What is not in the file: every net draws or decides it by itself."""


def starting_net(config: ModelConfig) -> HorizonFCN:
    """A net to be trained, with the weights that `config.start` names; see `starts_simulated`."""
    net = build_net(config)
    if starts_simulated(config):
        # Its masks and the heads' shares are its own: they depend on the config and on the recording.
        own = {name: net.state_dict()[name] for name in OWN}
        net.load_state_dict({**load_file(SIMULATED), **own})
    return net


def simulated_net() -> HorizonFCN:
    """The net of the simulated worlds as it is, to be asked what it calls an obstacle.

    It is made without a random number, not even one put back: an online run exports in a thread of its own,
    and the random numbers of torch belong to all threads.
    """
    with torch.device("meta"):
        net = build_net(ModelConfig())
    own = {name: net.state_dict()[name] for name in OWN}
    net.load_state_dict({**load_file(SIMULATED), **own}, assign=True)
    return net.to(memory_format=torch.channels_last).eval()


def starts_simulated(config: ModelConfig) -> bool:
    """Whether a net starts from the simulated worlds: only the small net of 32 channels has such weights.

    Example:
        >>> starts_simulated(ModelConfig()), starts_simulated(ModelConfig(channels=16))
        (True, False)
    """
    return config.start == "simulated" and config.kind == "fcn" and config.channels == 32


def start_of(config: ModelConfig) -> str:
    """What a net starts from, in a word for `run.json`: `simulated` or `random`."""
    return "simulated" if starts_simulated(config) else "random"

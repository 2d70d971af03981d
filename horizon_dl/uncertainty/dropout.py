"""Dropout at test time: a distribution of `p_above` instead of one number."""

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn
from torch.nn.modules.dropout import _DropoutNd

from horizon_dl.models.fcn import HorizonFCN, enlarge


def set_dropout(module: nn.Module, *, active: bool) -> None:
    """Switch every dropout layer on or off; batch norm and all else stay as they are."""
    for layer in module.modules():
        if isinstance(layer, _DropoutNd):
            layer.train(active)


def image_tensor(image: NDArray[np.uint8]) -> Tensor:
    """(1, 3, h, w) float in [0, 1] of an (h, w, 3) uint8 image."""
    return torch.from_numpy(np.ascontiguousarray(image)).permute(2, 0, 1)[None].float() / 255.0


@torch.inference_mode()
def sample_p_above(
    net: HorizonFCN, image: NDArray[np.uint8], samples: int, seed: int = 0
) -> NDArray[np.float32]:
    """`p_above` of one image under `samples` random dropout masks, (samples, h, w) in [0, 1].

    The encoder runs once, the head once per mask. The masks depend on the seed alone.
    Source: Gal and Ghahramani, Dropout as a Bayesian approximation, ICML 2016.
    """
    net.eval()
    features = net.encode(image_tensor(image))
    set_dropout(net.head, active=True)
    with torch.random.fork_rng(devices=[]):
        torch.manual_seed(seed)
        logits = net.head(features.expand(samples, -1, -1, -1))
    set_dropout(net.head, active=False)
    return _probabilities(logits, image)


@torch.inference_mode()
def single_pass_p_above(net: HorizonFCN, image: NDArray[np.uint8]) -> NDArray[np.float32]:
    """`p_above` of one image without dropout, (1, h, w) in [0, 1]."""
    net.eval()
    return _probabilities(net.head(net.encode(image_tensor(image))), image)


def _probabilities(logits: Tensor, image: NDArray[np.uint8]) -> NDArray[np.float32]:
    height, width = image.shape[:2]
    p: NDArray[np.float32] = enlarge(logits.sigmoid(), (height, width))[:, 0].numpy()
    return p

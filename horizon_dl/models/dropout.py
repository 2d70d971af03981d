"""Dropout at test time: a distribution of `p_above` instead of one number."""

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from horizon_dl.models.fcn import HorizonFCN, enlarge

Map = NDArray[np.float32]


def image_tensor(image: NDArray[np.uint8]) -> Tensor:
    """(1, 3, h, w) float in [0, 1] of an (h, w, 3) uint8 image."""
    return torch.tensor(image).permute(2, 0, 1)[None].float() / 255.0


@torch.inference_mode()
def sample_p_above(net: HorizonFCN, image: NDArray[np.uint8]) -> Map:
    """`p_above` of one image under each of the net's dropout masks, (masks, h, w) in [0, 1].

    Source: Gal and Ghahramani, Dropout as a Bayesian approximation, ICML 2016.
    """
    net.eval()
    return _probabilities(net.sample_logits(net.encode(image_tensor(image))), image.shape[:2])


@torch.inference_mode()
def single_pass_p_above(net: HorizonFCN, image: NDArray[np.uint8]) -> Map:
    """`p_above` of one image without dropout, (1, h, w) in [0, 1]."""
    net.eval()
    return _probabilities(net.judge(net.encode(image_tensor(image))), image.shape[:2])


@torch.inference_mode()
def p_above_of_all_depths(
    net: HorizonFCN, image: NDArray[np.uint8], size: tuple[int, ...] | None = None
) -> Map:
    """Mean of the probabilities that the heads at all depths give, without dropout, in [0, 1].

    Args:
        net: with one or more heads.
        image: (h, w, 3) uint8 RGB.
        size: height and width of the result; that of the image if left out.
    """
    net.eval()
    mean: Map = _probabilities(net(image_tensor(image)), size or image.shape[:2]).mean(axis=0)
    return mean


def _probabilities(logits: Tensor, size: tuple[int, ...]) -> Map:
    p: Map = enlarge(logits.sigmoid(), (size[0], size[1]))[0].numpy()
    return p

"""One image after one pass of a net's encoder: all that is asked of it then takes the last layers alone."""

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from horizon_dl.models.fcn import HorizonFCN, enlarge
from horizon_dl.uncertainty.measures import Measures, binary_entropy, surprisal

Map = NDArray[np.float32]


def image_tensor(image: NDArray[np.uint8]) -> Tensor:
    """(1, 3, h, w) float in [0, 1] of an (h, w, 3) uint8 image."""
    return torch.tensor(image).permute(2, 0, 1)[None].float() / 255.0


class EncodedImage:
    """What a net's heads judge an image by.

    Args:
        net: trained; its weights must not change while this is in use.
        image: (h, w, 3) uint8 RGB.
    """

    def __init__(self, net: HorizonFCN, image: NDArray[np.uint8]) -> None:
        net.eval()
        self._net, self._size = net, image.shape[:2]
        with torch.inference_mode():
            self._features = net.encode(image_tensor(image))

    @torch.inference_mode()
    def samples(self) -> Map:
        """`p_above` under each of the net's dropout masks, (masks, h, w) in [0, 1].

        Source: Gal and Ghahramani, Dropout as a Bayesian approximation, ICML 2016.
        """
        return _probabilities(self._net.sample_logits(self._features), self._size)

    @torch.inference_mode()
    def p_above(self) -> Map:
        """Mean of the samples, (h, w) in [0, 1]: enlarged once, as that is the mean of the enlarged ones."""
        mean = self._net.sample_logits(self._features).sigmoid().mean(dim=1, keepdim=True)
        found: Map = enlarge(mean, (self._size[0], self._size[1]))[0, 0].numpy()
        return found

    @torch.inference_mode()
    def single_pass(self) -> Map:
        """`p_above` without dropout, (1, h, w) in [0, 1]."""
        return _probabilities(self._net.judge(self._features), self._size)

    @torch.inference_mode()
    def of_all_depths(self, size: tuple[int, ...] | None = None) -> Map:
        """Mean of the probabilities that the heads at all depths give, without dropout, (h, w) in [0, 1]."""
        heads = self._net.heads()
        parts = self._features.chunk(len(heads), dim=1)
        logits = torch.cat([head.classifier(part) for head, part in zip(heads, parts, strict=True)], dim=1)
        mean: Map = _probabilities(logits, size or self._size).mean(axis=0)
        return mean

    @torch.inference_mode()
    def measures(self, above: NDArray[np.bool_]) -> Measures:
        """All measures as the exported file gives them: samples are summarised before they are enlarged.

        Enlarging sixteen maps and taking their entropies costs more than the net. The mean of the enlarged
        samples is the enlarged mean; of the mutual information that is nearly so, and this is its definition
        here. Equal to the outputs of the exported file to 1e-4.

        Args:
            above: (h, w) the side that each pixel really is on.
        """
        samples = self._net.sample_logits(self._features)[0].sigmoid().numpy()
        mean = samples.mean(axis=0)
        information = np.maximum(binary_entropy(mean) - binary_entropy(samples).mean(axis=0), np.float32(0.0))
        coarse = torch.from_numpy(np.stack([mean, information]))[None]
        p_above, mutual_information = enlarge(coarse, self._size)[0].numpy()
        entropy = binary_entropy(p_above)
        return Measures(
            p_above=p_above,
            entropy=entropy,
            expected_entropy=np.maximum(entropy - mutual_information, np.float32(0.0)),
            mutual_information=mutual_information,
            surprisal=surprisal(p_above, above),
        )


def _probabilities(logits: Tensor, size: tuple[int, ...]) -> Map:
    p: Map = enlarge(logits.sigmoid(), (size[0], size[1]))[0].numpy()
    return p

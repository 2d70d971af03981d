"""The measures of a net as its exported file gives them: samples are summarised before they are enlarged.

Enlarging sixteen maps and taking their entropies costs more than the net. The mean of the enlarged samples is
the enlarged mean; of the mutual information that is nearly so, and this is its definition here.
"""

import numpy as np
import torch
from numpy.typing import NDArray

from horizon_dl.models.dropout import image_tensor
from horizon_dl.models.fcn import HorizonFCN, enlarge
from horizon_dl.uncertainty.measures import Measures, binary_entropy, surprisal


@torch.inference_mode()
def net_measures(net: HorizonFCN, image: NDArray[np.uint8], above: NDArray[np.bool_]) -> Measures:
    """All measures of one image; equal to the outputs of the exported file to 1e-4.

    Args:
        net: trained.
        image: (h, w, 3) uint8 RGB.
        above: (h, w) the side that each pixel really is on.
    """
    net.eval()
    samples = net.sample_logits(net.encode(image_tensor(image)))[0].sigmoid().numpy()
    mean = samples.mean(axis=0)
    information = np.maximum(binary_entropy(mean) - binary_entropy(samples).mean(axis=0), np.float32(0.0))
    coarse = torch.from_numpy(np.stack([mean, information]))[None]
    p_above, mutual_information = enlarge(coarse, image.shape[:2])[0].numpy()
    entropy = binary_entropy(p_above)
    return Measures(
        p_above=p_above,
        entropy=entropy,
        expected_entropy=np.maximum(entropy - mutual_information, np.float32(0.0)),
        mutual_information=mutual_information,
        surprisal=surprisal(p_above, above),
    )

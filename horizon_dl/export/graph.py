"""The pipeline from camera image to obstacle map as one module, ready to be exported."""

from typing import NamedTuple

import numpy as np
import torch
from torch import Tensor, nn

from horizon_dl.export.encode import Encode
from horizon_dl.export.entropy import BITS, entropy, surprisal_of
from horizon_dl.export.forest_features import ForestFeatures
from horizon_dl.export.forest_trees import ML_DOMAIN, ML_OPSET, TreeVotes
from horizon_dl.export.resize import AreaShrink, NearestEnlarge
from horizon_dl.geometry.camera import Camera, working_size
from horizon_dl.geometry.rays import camera_rays
from horizon_dl.models.fcn import HorizonFCN, enlarge
from horizon_dl.models.forest import HorizonForest

LOG_TERMS = 32  # factors of a product whose logarithm is taken; each is at least a half


class Maps(NamedTuple):
    """Outputs of the graph, in the order of the file; see `OUTPUTS` of the card for units and ranges."""

    p_above: Tensor
    entropy: Tensor
    expected_entropy: Tensor
    mutual_information: Tensor
    surprisal: Tensor
    elevation: Tensor
    obstacles: Tensor


class Pipeline(nn.Module):
    """Camera image and attitude in; probability, uncertainties and obstacle map out.

    Dropout is inside as the net's own fixed masks times its last weights: no operator is random, and none
    is a dropout that a runtime would remove. Rays are constants, so a file belongs to one camera.

    Args:
        learner: a trained net in evaluation mode, or a fitted forest, whose trees are the samples.
        camera: of the upright images.
        max_pixels: as in training; fixes the working size.
        threshold: entropy above which a pixel is an obstacle, bits.
        sampled: False gives the net's single pass without dropout, for comparison of times alone.
    """

    def __init__(
        self,
        learner: HorizonFCN | HorizonForest,
        camera: Camera,
        max_pixels: int,
        threshold: float,
        *,
        sampled: bool = True,
    ) -> None:
        super().__init__()
        self.image_size = (camera.width, camera.height)
        self.size = working_size(camera.width, camera.height, max_pixels)
        self.resize = AreaShrink(self.image_size, self.size)
        interleaved = not self.resize.shrinks
        self.encode: nn.Module
        self.uncertainty: nn.Module
        self.further_opsets: dict[str, int] = {}
        if isinstance(learner, HorizonForest):
            self.further_opsets = {ML_DOMAIN: ML_OPSET}
            self.encode = ForestFeatures(self.size, interleaved=interleaved)
            self.uncertainty = TreeVotes(learner, self.size)
        else:
            self.encode = Encode(learner, interleaved=interleaved)
            self.uncertainty = Uncertainty(learner, self.size, sampled=sampled)
        self.horizon = Horizon(camera.scaled(*self.size))
        self.measures = MeasureMaps()
        self.obstacles = ObstacleMap(threshold, self.size, self.image_size)

    def forward(self, image: Tensor, up_cam: Tensor) -> Maps:
        """Maps of (1, H, W, 3) uint8 RGB and the (3,) up direction in the optical frame."""
        p_above, mutual_information = self.uncertainty(self.encode(self.resize(image)))
        elevation, above = self.horizon(up_cam)
        entropy, expected_entropy, surprisal = self.measures(p_above, mutual_information, above)
        obstacles = self.obstacles(entropy)
        return Maps(p_above, entropy, expected_entropy, mutual_information, surprisal, elevation, obstacles)


class Uncertainty(nn.Module):
    """Mean probability and mutual information of all dropout samples, enlarged to the working size.

    The samples themselves stay at the net's coarse grid; only their two summaries are enlarged. The mean is
    exactly that of enlarged samples. The mutual information is that of the coarse grid.
    """

    def __init__(self, net: HorizonFCN, size: tuple[int, int], *, sampled: bool) -> None:
        super().__init__()
        self.net, self.sampled = net, sampled
        self.enlarge = Enlarge(size)

    def forward(self, features: Tensor) -> tuple[Tensor, Tensor]:
        """Two (h, w) maps of (1, features, h / s, w / s)."""
        if not self.sampled:
            weight, bias = self.net.sample_weights()  # the masks' mean is one
            logits = nn.functional.conv2d(features, weight.mean(dim=0, keepdim=True), bias[:1])
            enlarged = self.enlarge(logits.sigmoid())[0, 0]
            return enlarged, torch.zeros_like(enlarged)
        logits = self.net.sample_logits(features)
        mean, expected = summaries(logits.flatten(2)[0])
        information = (entropy(mean) - expected).clamp(0.0, 1.0)
        rows, columns = logits.shape[-2:]
        wide = self.enlarge.columns(torch.stack([mean, information]).reshape(2, rows, columns))
        return self.enlarge.rows(wide[0]), self.enlarge.rows(wide[1])


def summaries(logits: Tensor) -> tuple[Tensor, Tensor]:
    """Mean probability and expected entropy in bits, (pixels,) each, of (samples, pixels) logits.

    Written for speed: with q the probability of the likelier side, H = (1 - q) |z| - log q takes one
    logarithm instead of two, many of which are taken as that of a product; q never is too small for a
    runtime's coarse sigmoid. Means are products with a row, which runtimes do best.
    """
    samples = logits.shape[0]
    p = logits.sigmoid()
    q = torch.maximum(p, 1 - p)
    product, terms = q, 1
    while terms < LOG_TERMS and product.shape[0] % 2 == 0:
        half = product.shape[0] // 2
        product, terms = product[:half] * product[half:], 2 * terms
    mean = torch.full((1, samples), 1 / samples)
    log_mean = torch.full((1, product.shape[0]), 1 / samples) @ product.log()
    expected = (mean @ ((1 - q) * logits.abs()) - log_mean) * BITS
    return (mean @ p)[0], expected[0]


class Enlarge(nn.Module):
    """The net's bilinear enlargement as two matrix products, faster than the operator for it."""

    def __init__(self, size: tuple[int, int]) -> None:
        super().__init__()
        self.size = size

    def forward(self, maps: Tensor) -> Tensor:
        """(..., h / s, w / s) to (..., h, w)."""
        return self.rows(self.columns(maps))

    def columns(self, maps: Tensor) -> Tensor:
        """(..., n, w / s) to (..., n, w)."""
        return maps @ bilinear_weights(int(maps.shape[-1]), self.size[0]).T

    def rows(self, maps: Tensor) -> Tensor:
        """(..., h / s, n) to (..., h, n)."""
        return bilinear_weights(int(maps.shape[-2]), self.size[1]) @ maps


def bilinear_weights(inputs: int, outputs: int) -> Tensor:
    """(outputs, inputs) weights of `enlarge` along one direction."""
    unit = torch.eye(inputs)[None, :, :, None]
    return enlarge(unit, (outputs, 1))[0, :, :, 0].T.contiguous()


class MeasureMaps(nn.Module):
    """What follows from the mean probability, the mutual information and the side of the horizon."""

    def forward(self, p_above: Tensor, information: Tensor, above: Tensor) -> tuple[Tensor, Tensor, Tensor]:
        """Entropy, expected entropy and surprisal, (h, w) bits.

        The entropy is the same from either side of the horizon; seen from the pixel's own, the surprisal is
        one of its terms.
        """
        p_side = (p_above - (1 - above.float())).abs()
        p_other = 1 - p_side
        surprisal = surprisal_of(p_side)
        found = (p_side * surprisal + p_other * surprisal_of(p_other)).clamp(0.0, 1.0)
        return found, (found - information).relu(), surprisal


class Horizon(nn.Module):
    """Elevation of every pixel from the camera's rays, NaN where lens model or attitude give none."""

    rays: Tensor
    no_ray: Tensor

    def __init__(self, camera: Camera) -> None:
        super().__init__()
        rays = camera_rays(camera)
        self.shape = (camera.height, camera.width)
        self.register_buffer("rays", torch.from_numpy(np.nan_to_num(rays.directions).reshape(-1, 3).T.copy()))
        self.register_buffer("no_ray", torch.from_numpy(np.where(rays.valid, 0.0, np.nan).astype(np.float32)))
        self.all_valid = bool(rays.valid.all())

    def forward(self, up_cam: Tensor) -> tuple[Tensor, Tensor]:
        """(h, w) elevation in rad, and whether it is positive."""
        sine = (up_cam.reshape(1, 3) @ self.rays).reshape(self.shape).clamp(-1.0, 1.0)
        # Clamping may lose a NaN; adding the input's own NaN brings it back.
        elevation = sine.asin() + up_cam.sum() * 0.0
        if not self.all_valid:
            elevation = elevation + self.no_ray
        return elevation, elevation > 0


class ObstacleMap(nn.Module):
    """Entropy over the threshold, without pixels that stand alone, at the image's size."""

    def __init__(self, threshold: float, size: tuple[int, int], image_size: tuple[int, int]) -> None:
        super().__init__()
        self.threshold, self.size, self.image_size = threshold, size, image_size
        self.enlarge = NearestEnlarge(size, image_size)

    def forward(self, entropy: Tensor) -> Tensor:
        """(H, W) uint8, 1 obstacle, of (h, w) bits."""
        over = (entropy > self.threshold).float()
        # The mean over 3x3 counts the pixel itself: with one neighbour it is 2/9.
        together = nn.functional.avg_pool2d(over[None, None], 3, stride=1, padding=1)
        found = (over * together.reshape(over.shape) > 1.5 / 9).to(torch.uint8)
        if self.size != self.image_size:
            enlarged: Tensor = self.enlarge(found)
            return enlarged
        return found

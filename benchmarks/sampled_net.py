"""The net sampled as most programs do it: whole passes under new dropout masks, summarised at full size."""

from collections.abc import Callable

import torch
from torch import Tensor, nn

from horizon_dl.data.view import View
from horizon_dl.export.entropy import entropy
from horizon_dl.export.graph import Horizon, MeasureMaps, ObstacleMap
from horizon_dl.geometry.camera import Camera
from horizon_dl.models.encoded import image_tensor
from horizon_dl.models.fcn import HorizonFCN, enlarge
from horizon_dl.uncertainty.measures import measures

SAMPLES, DROPOUT = 16, 0.25
THRESHOLD = 0.5


class Passes(nn.Module):
    """Whole passes of the net as it is, each under dropout masks of its own: (passes, h, w) probabilities."""

    def __init__(self, net: HorizonFCN, passes: int) -> None:
        super().__init__()
        self.net, self.passes = net, passes

    def forward(self, image: Tensor) -> Tensor:
        """Of (1, h, w, 3) uint8."""
        planes = image.permute(0, 3, 1, 2).float() / 255.0
        features = self.net.encode(planes.expand(self.passes, -1, -1, -1))
        chance = torch.rand_like(features[:, :, :1, :1])
        kept = (chance >= DROPOUT).float() / (1 - DROPOUT)
        logits = one_logit(self.net, features * kept)
        return enlarge(logits.sigmoid(), image.shape[1:3])[:, 0]


class Summary(nn.Module):
    """All outputs of the deployed file from samples at full size."""

    def __init__(self, camera: Camera) -> None:
        super().__init__()
        size = (camera.width, camera.height)
        self.horizon, self.measures = Horizon(camera), MeasureMaps()
        self.obstacles = ObstacleMap(THRESHOLD, size, size)

    def forward(self, samples: Tensor, up_cam: Tensor) -> tuple[Tensor, ...]:
        """Of (samples, h, w) probabilities."""
        mean = samples.mean(dim=0)
        information = (entropy(mean) - entropy(samples).mean(dim=0)).clamp(0.0, 1.0)
        elevation, above = self.horizon(up_cam)
        found, expected, surprisal = self.measures(mean, information, above)
        return mean, found, expected, information, surprisal, elevation, self.obstacles(found)


class Batch(nn.Module):
    """All passes as one batch, and their summary."""

    def __init__(self, net: HorizonFCN, camera: Camera) -> None:
        super().__init__()
        self.passes, self.summary = Passes(net, SAMPLES), Summary(camera)

    def forward(self, image: Tensor, up_cam: Tensor) -> tuple[Tensor, ...]:
        """All maps of (1, h, w, 3) uint8."""
        found: tuple[Tensor, ...] = self.summary(self.passes(image), up_cam)
        return found


def one_logit(net: HorizonFCN, features: Tensor) -> Tensor:
    """(N, 1, h / s, w / s): the last layer without masks, whose mean is one."""
    weight, bias = net.sample_weights()
    return nn.functional.conv2d(features, weight.mean(dim=0, keepdim=True), bias[:1])


def naive_torch(net: HorizonFCN, view: View) -> Callable[[], object]:
    """Sixteen passes under random dropout, as most programs do it."""

    def run() -> object:
        image = image_tensor(view.image)
        with torch.inference_mode():
            passes = [dropped(net.encode(image)) for _ in range(SAMPLES)]
        return measures(torch.cat(passes).numpy(), view.elevation > 0)

    def dropped(features: Tensor) -> Tensor:
        logits = one_logit(net, nn.functional.dropout2d(features, DROPOUT, training=True))
        return enlarge(logits.sigmoid(), view.image.shape[:2])[0]

    return run

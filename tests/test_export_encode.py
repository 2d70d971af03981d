"""The encoder with the scaling folded into its first layer, against the net's own."""

import pytest
import torch

from horizon_dl.config import ModelConfig
from horizon_dl.export.encode import Encode
from horizon_dl.models.build import build_net


@pytest.mark.parametrize("kind", ["fcn", "mobilenet_v3_small", "resnet18"])
@pytest.mark.parametrize("size", [(48, 64), (45, 63), (46, 61)])
@pytest.mark.parametrize("interleaved", [True, False])
def test_it_gives_the_nets_features(kind, size, interleaved):
    torch.manual_seed(0)
    net = build_net(ModelConfig(kind=kind)).train()
    image = torch.randint(0, 256, (1, *size, 3), dtype=torch.uint8)
    planes = image.permute(0, 3, 1, 2).float()
    with torch.no_grad():
        net(planes / 255)  # the batch norms learn something
        net.eval()
        wanted = net.encode(planes / 255)
        found = Encode(net, interleaved=interleaved)(image if interleaved else planes)
    torch.testing.assert_close(found, wanted, atol=2e-5, rtol=1e-4)
    assert wanted.abs().max() > 0.1

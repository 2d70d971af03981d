import numpy as np
import pytest
import torch

from horizon_dl.config import ModelConfig
from horizon_dl.models.build import build_net, parameter_count
from horizon_dl.models.encoded import EncodedImage, image_tensor
from horizon_dl.models.fcn import balanced_masks, enlarge

KINDS = ("fcn", "mobilenet_v3_small", "resnet18")


@pytest.fixture(params=KINDS)
def net(request):
    torch.manual_seed(0)
    net = build_net(ModelConfig(kind=request.param))
    # Batch norm must have seen something, or the features are not what they are after training.
    net.train()
    with torch.no_grad():
        net(torch.rand(4, 3, 64, 80))
    return net.eval()


@pytest.fixture
def image():
    return np.random.default_rng(0).integers(0, 256, (61, 83, 3)).astype(np.uint8)


def test_the_default_net_is_small():
    assert parameter_count(build_net(ModelConfig())) <= 100_000


def test_any_size_gives_a_map_of_that_size(net):
    for height, width in ((61, 83), (32, 32), (187, 621)):
        image = np.zeros((height, width, 3), np.uint8)
        assert EncodedImage(net, image).samples().shape == (16, height, width)
        assert EncodedImage(net, image).single_pass().shape == (1, height, width)


def test_sampling_is_dropout_with_the_kept_masks(net, image):
    """Against masks multiplied onto the features by hand, one pass each."""
    with torch.no_grad():
        features = net.encode(image_tensor(image))
        masked = [features * mask[None, :, None, None] for mask in net.masks]
        one_by_one = torch.cat([net.judge(part) for part in masked], dim=1)
        together = net.sample_logits(features)
    torch.testing.assert_close(together, one_by_one, rtol=1e-4, atol=1e-5)


def test_samples_differ_from_the_single_pass_and_centre_on_it(net, image):
    samples = EncodedImage(net, image).samples()
    np.testing.assert_allclose(EncodedImage(net, image).p_above(), samples.mean(axis=0), atol=1e-6)
    assert samples.shape == (16, 61, 83)
    assert samples.std(axis=0).max() > 1e-3
    with torch.no_grad():
        features = net.encode(image_tensor(image))
        mean_logit = net.sample_logits(features).mean(dim=1, keepdim=True)
        torch.testing.assert_close(mean_logit, net.judge(features), rtol=1e-3, atol=1e-4)


def test_the_single_pass_is_the_mean_of_the_logits_of_all_depths(net, image):
    with torch.no_grad():
        logits = net(image_tensor(image))
        assert (logits[:, 0] - logits[:, 1]).abs().max() > 1e-3
        mean = enlarge(logits.mean(dim=1, keepdim=True).sigmoid(), image.shape[:2])
    assert np.allclose(EncodedImage(net, image).single_pass(), mean[0].numpy(), atol=1e-5)


def test_all_depths_are_the_mean_of_the_heads(net, image):
    with torch.no_grad():
        p_above = enlarge(net(image_tensor(image)).sigmoid(), image.shape[:2])[0].numpy()
    assert np.allclose(EncodedImage(net, image).of_all_depths(), p_above.mean(axis=0), atol=1e-5)


def test_predictions_repeat_and_leave_the_random_state_alone(net, image):
    state = torch.get_rng_state()
    assert np.array_equal(EncodedImage(net, image).samples(), EncodedImage(net, image).samples())
    assert torch.equal(state, torch.get_rng_state())


def test_prediction_changes_no_batch_statistics(net, image):
    before = {name: value.clone() for name, value in net.state_dict().items()}
    net.train()
    EncodedImage(net, image).samples()
    EncodedImage(net, image).single_pass()
    assert all(torch.equal(value, before[name]) for name, value in net.state_dict().items())


def test_training_drops_whole_maps_at_random(net):
    net.deep.dropout.train()
    dropped = net.deep.dropout(torch.ones(200, 64, 2, 2))
    assert torch.equal(dropped[..., 0, 0], dropped[..., 1, 1])
    assert (dropped == 0).float().mean().item() == pytest.approx(net.deep.dropout.p, abs=0.03)


@pytest.mark.parametrize(
    ("samples", "rate", "dropped"), [(16, 0.25, 4), (16, 0.5, 8), (1, 0.5, 0), (4, 0.9, 3)]
)
def test_masks_drop_every_feature_equally_often(samples, rate, dropped):
    masks = balanced_masks(samples, 500, rate)
    assert torch.equal((masks == 0).sum(0), torch.full((500,), dropped))
    torch.testing.assert_close(masks.mean(0), torch.ones(500))
    if 0 < dropped < samples:
        assert len(masks.unique(dim=0)) == samples


def test_balanced_masks_beat_independent_ones():
    """Closeness of the mean probability to that of 20,000 samples, for random features and weights."""
    generator = torch.Generator().manual_seed(1)
    activations = torch.randn(300, 32, generator=generator).relu() * torch.randn(32, generator=generator)

    def mean_p(masks):
        return (activations @ masks.T).sigmoid().mean(1)

    limit = mean_p((torch.rand(20_000, 32, generator=generator) < 0.75) / 0.75)
    independent = mean_p((torch.rand(16, 32, generator=generator) < 0.75) / 0.75)
    balanced = mean_p(balanced_masks(16, 32, 0.25))
    assert (balanced - limit).abs().mean() < 0.7 * (independent - limit).abs().mean()

import sys
from pathlib import Path

import numpy as np
import pytest
import torch

sys.path.insert(0, str(Path(__file__).parent.parent / "benchmarks"))

from figures import PARTS, Job, jobs_of, results
from places import EVERYWHERE, HEAD, PLACES, analytic_mean, drawn_samples, place_dropout
from shade import lit_and_shaded

from horizon_dl.config import ModelConfig
from horizon_dl.data.frame import Frame
from horizon_dl.geometry.camera import Camera
from horizon_dl.metrics.scored_pixels import scored_pixels
from horizon_dl.models.build import build_net


@pytest.fixture
def net():
    """Untrained, with logits spread enough that dropout matters."""
    with torch.random.fork_rng(devices=[]):
        torch.manual_seed(0)
        net = build_net(ModelConfig())
        for head in net.heads():
            head.classifier.weight.data.mul_(30.0)
        yield net.eval()


@pytest.fixture
def image():
    return torch.rand((1, 3, 32, 48), generator=torch.Generator().manual_seed(1))


def test_the_analytic_mean_is_that_of_many_draws(net, image):
    drawn = drawn_samples(net, PLACES[0], image, 8000)
    analytic = analytic_mean(net, image)
    assert drawn.std(dim=0).max() > 0.1  # there is something to average
    assert analytic == pytest.approx(drawn.mean(dim=0), abs=0.02)
    single = net.judge(net.encode(image))[0, 0].sigmoid()
    assert (single - drawn.mean(dim=0)).abs().max() > 0.05


@pytest.mark.parametrize("place", PLACES)
def test_dropout_at_rate_nought_changes_nothing(net, image, place):
    placed = place_dropout(net, place)
    for module in placed.modules():
        if isinstance(module, torch.nn.Dropout2d):
            module.p = 0.0
    samples = drawn_samples(placed, place, image, 6)
    single = net.judge(net.encode(image))[0, 0].sigmoid()
    assert samples.shape == (6, *single.shape)
    assert torch.allclose(samples, single.expand(6, -1, -1).detach(), atol=1e-5)


@pytest.mark.parametrize(("place", "inside"), [(HEAD, 2 * 2), (EVERYWHERE, 2 * 2 + 6)])
def test_placed_dropout_makes_the_samples_differ(net, image, place, inside):
    placed = place_dropout(net, place)
    assert sum(isinstance(module, torch.nn.Dropout2d) for module in placed.modules()) == inside
    assert all(isinstance(head.neck[0], torch.nn.Dropout2d) for head in placed.heads())
    samples = drawn_samples(placed, place, image, 9)
    assert samples.std(dim=0).min() > 0
    assert not any(isinstance(module, torch.nn.Dropout2d) and module.training for module in placed.modules())
    assert len(list(net.deep.neck)) == 2  # the net itself is as it was


def test_shade_is_floor_darker_than_the_frame_s_floor():
    truth = np.ones((8, 8), np.uint8)
    truth[:, 0] = 2
    image = np.full((8, 8, 3), 100, np.uint8)
    image[:, 0] = 10
    image[:, 1] = 50
    image[:, 2] = 70
    camera = Camera("pinhole", 8, 8, 8.0, 8.0, 3.5, 3.5)
    frame = Frame("a", 0.0, np.array([0.0, -1.0, 0.0]), image=image, camera=camera, truth=truth)
    pixels = scored_pixels(frame)
    lit, shade = lit_and_shaded(frame, pixels)
    columns = np.nonzero(pixels.mask)[1]
    assert set(columns[shade]) == {1}
    assert set(columns[lit]) == set(range(2, 8))
    assert not (shade & pixels.obstacle).any()


def test_jobs_come_back_in_their_order_whoever_ends_first():
    jobs = [
        Job("methods", ("a",), pow, (2, 3)),
        Job("ablations", ("x", "b"), pow, (3, 2)),
        Job("ablations", ("x", "a"), pow, (5, 2)),
        Job("ablations", ("w", "a"), pow, (7, 2)),
    ]
    found = results(jobs, processes=1)
    assert found == {"methods": {"a": 8}, "ablations": {"x": {"b": 9, "a": 25}, "w": {"a": 49}}}
    assert list(found["ablations"]) == ["x", "w"]
    assert list(found["ablations"]["x"]) == ["b", "a"]


def test_every_part_has_jobs_and_novelty_comes_last(tmp_path):
    jobs = list(jobs_of(PARTS, ["embedded", "kitti"], range(3), tmp_path))
    assert {job.part for job in jobs} == set(PARTS)
    assert [job.part for job in jobs[-2:]] == ["novelty", "novelty"]
    assert [job.keys for job in jobs if job.part == "shade"] == [("kitti",)]
    assert all(job.arguments[0] == job.keys[-1] for job in jobs)

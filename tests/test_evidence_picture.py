"""Evidence in a single picture: exposure, damage, the net's horizon, the place, and single sectors."""

import json
import math

import numpy as np
import pytest

from horizon_dl.evidence.appearance import FEATURES, appearance
from horizon_dl.evidence.damage import channel_is_lost, damage, is_combed, is_torn
from horizon_dl.evidence.exposure import exposure_problem
from horizon_dl.evidence.horizon_skill import horizon_accuracy
from horizon_dl.evidence.limits import LIMITS
from horizon_dl.evidence.place import Place, PlaceCalibration, usual_levels
from horizon_dl.evidence.reason import Reason
from horizon_dl.evidence.sectors import box_mean, claimed_share, lost_pixels
from horizon_dl.evidence.sketch import luma, sketch_of
from horizon_dl.geometry.camera import Camera
from horizon_dl.geometry.horizon import elevation
from horizon_dl.geometry.polar import bearings_for, polar_view
from horizon_dl.geometry.rays import camera_rays
from horizon_dl.ranging.contact import ContactDetectorParams
from horizon_dl.ranging.free_distance import free_distances
from horizon_dl.ranging.rules import RangingParams
from horizon_dl.ranging.sectors import Outcome
from horizon_dl.ranging.usual_levels import UsualLevels

CAMERA = Camera("pinhole", 160, 120, 120.0, 120.0, 79.5, 59.5)
UP = np.array([0.0, -1.0, 0.0])
RAYS = camera_rays(CAMERA).directions
ELEVATION = elevation(RAYS, UP)
P_ABOVE = np.where(ELEVATION > 0, 0.9, 0.1).astype(np.float32)


def scene(seed: int = 0, noise: float = 4.0) -> np.ndarray:
    """Blocks of many colours above the horizon, a noisy brown floor with marks below it."""
    rng = np.random.default_rng(seed)
    blocks = np.repeat(np.repeat(rng.integers(90, 220, (12, 16, 3)), 10, 0), 10, 1).astype(float)
    floor = np.array([110.0, 90.0, 70.0]) + 12 * np.sin(np.arange(160) / 5.0)[None, :, None]
    image = np.where(ELEVATION[..., None] > 0, blocks, floor) + rng.normal(0, noise, (120, 160, 3))
    return image.clip(0, 255).astype(np.uint8)


def place(count: int = 8) -> Place:
    calibration = PlaceCalibration()
    for seed in range(count):
        calibration.add(scene(seed), ELEVATION, P_ABOVE)
    found = calibration.place()
    assert found is not None
    return found


@pytest.mark.parametrize(
    ("level", "noise", "reason"),
    [
        (0, 0, Reason.DARK),
        (3, 2, Reason.DARK),
        (255, 0, Reason.BRIGHT),
        (128, 0, Reason.FLAT),
        (160, 8, Reason.FLAT),
    ],
)
def test_a_covered_or_blinded_lens_shows_nothing(level: int, noise: float, reason: Reason) -> None:
    rng = np.random.default_rng(0)
    image = np.clip(level + rng.normal(0, noise, (480, 640, 3)), 0, 255).astype(np.uint8)
    assert exposure_problem(sketch_of(image)) is reason


def test_an_ordinary_picture_has_no_fault() -> None:
    assert exposure_problem(sketch_of(scene())) is None
    assert damage(scene()) is None
    assert not lost_pixels(scene()).any()
    assert place().strangeness(appearance(scene(99), ELEVATION, P_ABOVE))[0] < LIMITS.strangeness


@pytest.mark.parametrize("channel", [0, 1, 2])
def test_a_lost_colour_is_seen(channel: int) -> None:
    image = scene()
    image[..., channel] = 7
    assert channel_is_lost(image)
    assert damage(image) is Reason.CHANNEL
    grey = np.repeat(scene()[..., :1], 3, axis=2)
    assert not channel_is_lost(grey)  # a grey camera is none that lost a colour


def poles() -> np.ndarray:
    """Upright stripes of many colours, with noise: rows look much like the rows next to them."""
    rng = np.random.default_rng(1)
    stripes = (
        np.repeat(rng.integers(60, 220, (16, 3)), 10, 0)[None] * np.linspace(1.0, 0.8, 120)[:, None, None]
    )
    return (stripes + rng.normal(0, 3, (120, 160, 3))).clip(0, 255).astype(np.uint8)


@pytest.mark.parametrize("pixels", [-30, -8, 8, 30])
def test_a_tear_is_seen_and_an_edge_of_the_scene_is_none(pixels: int) -> None:
    image = poles()
    torn = image.copy()
    torn[25:] = np.roll(torn[25:], pixels, axis=1)
    assert is_torn(luma(torn))
    assert damage(torn) is Reason.TORN
    assert not is_torn(luma(image))
    edge = image.copy()
    edge[70:] = edge[70:] // 2  # a bright wall ends along a row
    assert not is_torn(luma(edge))


def test_rows_of_two_frames_are_seen() -> None:
    image = scene()
    combed = image.copy()
    combed[::2] = scene(1)[::2]
    assert is_combed(luma(combed))
    assert not is_combed(luma(image))
    noise = np.random.default_rng(0).normal(128, 20, (120, 160)).astype(np.float32)
    assert not is_combed(noise)


@pytest.mark.parametrize("p", [0.0, 0.2, 0.5, 0.8, 1.0])
def test_a_net_that_says_the_same_everywhere_has_no_skill(p: float) -> None:
    assert horizon_accuracy(np.full(ELEVATION.shape, p), ELEVATION) <= 0.5


def test_the_horizons_accuracy_is_balanced_and_leaves_the_band_out() -> None:
    assert horizon_accuracy(P_ABOVE, ELEVATION) == 1.0
    assert horizon_accuracy(1 - P_ABOVE, ELEVATION) == 0.0
    half = np.where(np.arange(160) < 80, P_ABOVE, 0.1)  # right half: all is floor
    assert horizon_accuracy(half, ELEVATION) == pytest.approx(0.75, abs=0.01)
    near = np.where(np.abs(ELEVATION) < LIMITS.band_rad, 1 - P_ABOVE, P_ABOVE)
    assert horizon_accuracy(near, ELEVATION) == 1.0
    assert math.isnan(horizon_accuracy(P_ABOVE, np.full(ELEVATION.shape, -0.5)))
    assert math.isnan(horizon_accuracy(P_ABOVE, np.full(ELEVATION.shape, np.nan)))


@pytest.mark.parametrize(
    "change",
    [
        lambda image: image // 4,
        lambda image: 255 - image // 3,
        lambda image: image[..., [2, 0, 1]],
        lambda image: np.random.default_rng(0).integers(0, 255, image.shape).astype(np.uint8),
        lambda image: (image * 0.1 + 150).astype(np.uint8),
    ],
    ids=["dark", "bright", "colours", "noise", "fog"],
)
def test_an_unfamiliar_picture_is_strange(change) -> None:
    assert place().strangeness(appearance(change(scene(99)), ELEVATION, P_ABOVE))[0] > LIMITS.strangeness


def test_a_net_that_is_worse_than_in_training_is_strange_and_a_better_one_is_not() -> None:
    known = place()
    features = appearance(scene(), ELEVATION, P_ABOVE)
    worse, better = features.copy(), features.copy()
    index = FEATURES.index("horizon_accuracy")
    worse[index], better[index] = known.low[index] - 0.2, 1.0
    assert known.strangeness(worse)[0] > LIMITS.strangeness
    assert known.strangeness(better)[0] < LIMITS.strangeness


def test_colours_never_seen_below_the_horizon() -> None:
    image = scene(50)
    assert place().unfamiliar(image)[ELEVATION < 0].mean() < 0.01
    image[ELEVATION < 0] = (20, 200, 40)
    assert place().unfamiliar(image)[ELEVATION < 0].all()


def test_the_limits_survive_the_card() -> None:
    known = place()
    again = Place.from_card(json.loads(json.dumps(known.to_card(), allow_nan=False)))
    assert (again.low, again.high, again.frames) == (known.low, known.high, known.frames)
    assert again.offset_rad == known.offset_rad == pytest.approx((0.0, 0.0), abs=math.radians(0.5))
    np.testing.assert_array_equal(again.colours, known.colours)
    other = known.at_another_size()
    small = appearance(scene(3)[::2, ::2], ELEVATION[::2, ::2], P_ABOVE[::2, ::2])
    assert other.strangeness(small)[0] < LIMITS.strangeness


@pytest.mark.parametrize(
    "damaged",
    [
        None,
        3,
        {},
        {"version": 2},
        {"colours": "zz"},
        {"colours": "00"},
        {"frames": "many"},
        {"frames": 0},
        {"horizon_accuracy": math.nan},
        {"ranges": {}},
        {"ranges": {name: [1.0, 0.0] for name in FEATURES}},
        {"ranges": {name: [math.nan, 1.0] for name in FEATURES}},
        {"ranges": dict.fromkeys(FEATURES, "ab")},
        {"ranges": [1, 2]},
        {"floor_p": 1.5},
        {"obstacle_p": -0.1},
        {"obstacle_p": math.nan},
        {"obstacle_p": "high"},
        {"horizon_offset_rad": 0.1},
        {"horizon_offset_rad": [0.1]},
        {"horizon_offset_rad": [0.1, 0.0]},
        {"horizon_offset_rad": [math.nan, 0.1]},
        {"horizon_offset_rad": ["a", "b"]},
        {"flat": "zz"},
        {"flat": "00"},
        {"flat": 3},
    ],
)
def test_damaged_limits_are_told(damaged: object) -> None:
    card = {**place().to_card(), **damaged} if isinstance(damaged, dict) and damaged else damaged
    with pytest.raises(ValueError, match="evidence limits"):
        Place.from_card(card)


def test_the_usual_floor_is_the_median_of_the_pictures_own_levels() -> None:
    rng = np.random.default_rng(1)
    calibration = PlaceCalibration(ranging=RangingParams(rise=ContactDetectorParams(floor_percentile=20.0)))
    levels = []
    for seed in range(5):
        p = np.where(ELEVATION > 0, 0.9, rng.uniform(0.02, 0.4, ELEVATION.shape)).astype(np.float32)
        calibration.add(scene(seed), ELEVATION, p)
        ground = np.sort(p[np.rad2deg(ELEVATION) < -1.0].astype(np.float64))
        levels.append(ground[round(0.2 * (len(ground) - 1))])
    found = calibration.place()
    assert found is not None
    assert found.floor_p == pytest.approx(sorted(levels)[2], abs=1e-3)
    assert Place.from_card(found.to_card()).floor_p == found.floor_p
    assert usual_levels(found, 0.5) == UsualLevels(found.floor_p)
    told = calibration.place(obstacle_p=0.3)
    assert told is not None
    assert usual_levels(Place.from_card(told.to_card()), 0.5) == UsualLevels(found.floor_p, 0.3)


def test_a_card_of_before_falls_back_on_the_threshold() -> None:
    without = ("floor_p", "obstacle_p")
    card = {key: value for key, value in place().to_card().items() if key not in without}
    older = Place.from_card(card)
    assert older.floor_p is None
    # Binary entropy of .11 is .49992 bits.
    assert usual_levels(older, 0.5).floor == pytest.approx(0.11, abs=1e-3)
    assert usual_levels(older, 0.5).obstacle is None
    assert usual_levels(None, 0.5) == usual_levels(older, 0.5)


def smoothed(colour: tuple[int, int, int], seed: int = 0) -> np.ndarray:
    """As a codec leaves it: half of the floor without any change."""
    image = scene(seed)
    image[90:][ELEVATION[90:] < 0] = colour
    return image


def place_of_smoothed(colour: tuple[int, int, int]) -> Place:
    calibration = PlaceCalibration()
    for seed in range(8):
        calibration.add(smoothed(colour, seed), ELEVATION, P_ABOVE)
    found = calibration.place()
    assert found is not None
    return Place.from_card(json.loads(json.dumps(found.to_card(), allow_nan=False)))


def test_flat_ground_as_in_the_training_pictures_is_not_lost() -> None:
    brown = place_of_smoothed((108, 90, 70))
    assert brown.usually_flat(smoothed((108, 90, 70)))[95:].all()
    for filled in ((128, 128, 128), (0, 135, 0), (0, 0, 0), (255, 255, 255)):
        assert not brown.usually_flat(smoothed(filled))[95:].any()
    assert place().flat is not None
    assert not place().usually_flat(smoothed((108, 90, 70))).any()  # never flat there


@pytest.mark.parametrize(
    "colour", [(0, 0, 0), (16, 16, 16), (0, 0, 18), (255, 255, 255), (255, 255, 230), (90, 250, 80)]
)
def test_no_light_and_too_much_are_never_usual(colour: tuple[int, int, int]) -> None:
    assert not place_of_smoothed(colour).usually_flat(smoothed(colour)).any()


def test_a_card_of_before_knows_of_no_flat_ground() -> None:
    older = Place.from_card({key: value for key, value in place().to_card().items() if key != "flat"})
    assert older.flat is None
    assert not older.usually_flat(smoothed((108, 90, 70))).any()


def test_no_picture_with_a_horizon_gives_no_limits() -> None:
    calibration = PlaceCalibration()
    assert calibration.place() is None
    calibration.add(scene(), np.full(ELEVATION.shape, -0.4), P_ABOVE)
    assert calibration.place() is None


@pytest.mark.parametrize("fill", [0, 128, 255])
def test_what_was_lost_is_found_and_nothing_else(fill: int) -> None:
    image = scene()
    image[80:, 40:100] = fill
    lost = lost_pixels(image)
    assert lost[85:, 45:95].all()
    outside = np.ones(lost.shape, bool)
    outside[76:, 36:104] = False
    assert not lost[outside].any()


def test_box_mean_against_a_loop() -> None:
    values = np.random.default_rng(0).normal(size=(9, 11)).astype(np.float32)
    padded = np.pad(values, 2, "edge")
    expected = [[padded[v : v + 5, u : u + 5].mean() for u in range(11)] for v in range(9)]
    np.testing.assert_allclose(box_mean(values, 5), expected, atol=1e-5)


def test_only_the_floor_that_a_sector_claims_counts() -> None:
    polar = polar_view(RAYS, UP, bearings=bearings_for(RAYS, (0, 0, 1.0)))
    wall = (ELEVATION > -0.2) & (np.arange(160) >= 80)  # on the right a wall that stands close
    found = free_distances(wall, polar, 1.0)
    far = (ELEVATION < 0) & (ELEVATION > -0.15)  # lost ground that lies behind the wall
    share = claimed_share(found, polar, far)
    free, met = found.outcome == Outcome.FREE, found.outcome == Outcome.OBSTACLE
    assert free.any()
    assert met.any()
    assert (share[free] > 0.2).all()
    assert (share[met][1:-1] == 0).all()
    assert (share[found.outcome == Outcome.UNKNOWN] == 0).all()

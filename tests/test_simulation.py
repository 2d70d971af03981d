"""Simulated worlds: exact geometry, safe flights, the embedded set."""

import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest
import yaml
from PIL import Image

from horizon_dl.data.frame import Truth
from horizon_dl.errors import InputError
from horizon_dl.readers.registry import open_recording
from horizon_dl.simulation import rendering
from horizon_dl.simulation import simulate as simulate_module
from horizon_dl.simulation.embedded import DEPTH_EVERY, FRAMES, SEED, embedded_set
from horizon_dl.simulation.faces import Face
from horizon_dl.simulation.flight import CLEARANCE_M, RATE_HZ, fitting_flight
from horizon_dl.simulation.kinds import KINDS
from horizon_dl.simulation.layout import Arena, at_a_wall, beside_the_way
from horizon_dl.simulation.noise import value_noise
from horizon_dl.simulation.office import MUTED
from horizon_dl.simulation.pose import optical_axes
from horizon_dl.simulation.rig import DRONE
from horizon_dl.simulation.scene import Scene, build_scene
from horizon_dl.simulation.sensor import GAMMA, TARGET, AutoExposure, develop
from horizon_dl.simulation.shots import Conditions, Shot, draw_flight, render_flight
from horizon_dl.simulation.simulate import simulate
from horizon_dl.simulation.solid import Part, Solid
from horizon_dl.simulation.things import car, hedge, shelf
from horizon_dl.simulation.walls import wall_faces
from horizon_dl.simulation.worlds import (
    ABOUT_AN_OFFICE,
    AT_OFFICE_WALLS,
    AT_WALLS,
    IN_A_HALLWAY,
    IN_AN_OFFICE,
    INDOORS,
    ON_A_PAVEMENT,
    OUTDOORS,
    WORLDS,
)

LOOKING_NORTH = np.array([[0.0, 0, 1], [-1, 0, 0], [0, -1, 0]])  # columns right (east), down, forward
YARD = Arena(12.0, 12.0, 3.0, True, ("green", "blue", "grey"), ())


@pytest.fixture(scope="session")
def gl() -> None:
    """Skips where the machine has no OpenGL, which rendering needs and flying does not."""
    plain = Scene(YARD, (), (), ())
    try:
        with rendering.SceneRenderer(plain, 64, 48, 50.0):
            pass
    except InputError as error:
        pytest.skip(str(error))


@pytest.mark.slow
def test_torch_compiler_loads_after_rendering(gl: None) -> None:
    if find_spec("triton") is None:
        pytest.skip("this torch has no compiler")
    code = (
        "from horizon_dl.simulation.shots import Conditions, draw_flight, render_flight\n"
        "from horizon_dl.simulation.worlds import WORLDS\n"
        "scene, rig, flight = draw_flight(WORLDS['arena'], 1, 20)\n"
        "next(iter(render_flight(scene, rig, flight, Conditions(seed=1, frames=20), (64, 48), only={6})))\n"
        "import torch._dynamo\n"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def label_and_depth(name: str) -> tuple[np.ndarray, np.ndarray]:
    stem = Path(name).stem
    labels = np.array(Image.open(embedded_set() / "labels" / f"{stem}.png"))
    return labels, np.array(Image.open(embedded_set() / "depth" / f"{stem}.png"))


def pixel_rays(width: int, height: int, focal: float) -> np.ndarray:
    v, u = np.mgrid[:height, :width]
    return np.stack(((u - (width - 1) / 2) / focal, (v - (height - 1) / 2) / focal, np.ones_like(u)), axis=-1)


# The embedded set


def test_embedded_set_is_small_and_complete() -> None:
    files = [path for path in embedded_set().rglob("*") if path.is_file()]
    assert sum(path.stat().st_size for path in files) <= 4_000_000
    recording = open_recording(embedded_set())
    assert recording.length == FRAMES
    assert all(entry.labelled for entry in recording.headers)
    with_depth = [index for index, files in enumerate(recording.load.files) if files.ranges is not None]
    assert with_depth == list(range(5, FRAMES, DEPTH_EVERY))


def test_embedded_floor_lies_at_the_stated_height_below_the_camera() -> None:
    """Depth, labels, camera file, mount, attitude and the project's own geometry, all against each other."""
    recording = open_recording(embedded_set())
    for index in range(5, FRAMES, 40):
        frame = recording.read(index)
        labels, depth = label_and_depth(frame.name)
        points = pixel_rays(320, 240, frame.camera.fx) * depth[..., None] / 1000.0
        height = points @ frame.up_cam
        floor = labels == Truth.FLOOR
        assert np.abs(height[floor] + frame.height_m).max() < 0.003
        assert height[labels == Truth.OBSTACLE].min() > -frame.height_m - 0.003
        assert height[labels == Truth.ABOVE].min() > 0


def test_embedded_set_is_neither_trivial_nor_one_sided() -> None:
    recording = open_recording(embedded_set())
    scores, truths, tilts = [], [], []
    for index in range(5, FRAMES, 10):
        frame = recording.read(index)
        rays = pixel_rays(320, 240, frame.camera.fx)
        sine = (rays @ frame.up_cam) / np.linalg.norm(rays, axis=-1)
        judged = (sine < 0) & (frame.truth > 0)
        assert 0.2 < (sine < 0).mean() < 0.9
        scores.append(sine[judged])
        truths.append(frame.truth[judged] == Truth.OBSTACLE)
        tilts.append(np.arctan2(frame.up_cam[0], -frame.up_cam[1]))
    score, truth = np.concatenate(scores), np.concatenate(truths)
    ranks = np.argsort(np.argsort(score, kind="stable"), kind="stable") + 1.0
    positives, negatives = truth.sum(), (~truth).sum()
    auc = (ranks[truth].sum() - positives * (positives + 1) / 2) / (positives * negatives)
    assert 0.8 < auc < 0.9  # nearness to the horizon alone
    assert 0.3 < truth.mean() < 0.7
    assert np.ptp(np.rad2deg(tilts)) > 10


def test_embedded_set_is_what_the_command_renders(gl: None) -> None:
    indices = {5, 95}
    drawn, conditions = draw_flight(WORLDS["arena"], SEED, FRAMES), Conditions(SEED, FRAMES)
    shots = render_flight(*drawn, conditions, (320, 240), indices)
    for index, shot in zip(sorted(indices), shots, strict=True):
        labels, depth = label_and_depth(f"{index:05d}.png")
        assert (shot.truth == labels).mean() > 0.999
        away = np.abs(shot.depth_m * 1000 - depth)[shot.truth == labels]
        assert np.quantile(away, 0.999) < 5  # millimetres


# Rendering


def test_marker_appears_where_the_pinhole_puts_it(gl: None) -> None:
    """A marker 4 m north, 1 m east, 0.5 m over a camera at 1 m height, no model of ours in between."""
    marker = Face((4.0, -1.0, 1.5), (0.0, -1.0, 0.0), (0.0, 0.0, 1.0), (0.2, 0.1), 0, Truth.OBSTACLE)
    scene = Scene(YARD, (marker,), (), (np.full((8, 8, 3), 200, np.uint8),))
    with rendering.SceneRenderer(scene, 320, 240, 200.0) as renderer:
        truth, depth = renderer.truth(np.array((0.0, 0, 1)), LOOKING_NORTH)
    v, u = np.nonzero(truth == Truth.OBSTACLE)
    assert u.mean() == pytest.approx(159.5 + 200 * 1.0 / 4.0, abs=0.3)
    assert v.mean() == pytest.approx(119.5 - 200 * 0.5 / 4.0, abs=0.3)
    assert len(u) == pytest.approx(20 * 10, abs=30)
    np.testing.assert_allclose(depth[truth == Truth.OBSTACLE], 4.0, atol=0.002)
    assert (depth[truth == Truth.ABOVE] == 0).all()  # sky


def test_pictures_hang_upright(gl: None) -> None:
    picture = np.full((32, 32, 3), 20, np.uint8)
    picture[:16, :16] = (250, 20, 20)
    wall = Face((2.0, 0.0, 1.0), (0.0, -1.0, 0.0), (0.0, 0.0, 1.0), (1.0, 1.0), 0, Truth.OBSTACLE)
    with rendering.SceneRenderer(Scene(YARD, (wall,), (), (picture,)), 160, 160, 160.0) as renderer:
        image = renderer.colour(np.array((0.0, 0, 1)), LOOKING_NORTH).astype(int)
    red = (image[..., 0] - image[..., 2] > 60)[
        5:-5, 5:-5
    ]  # the picture repeats: its rim mixes with the far side
    assert red[:70, :70].all()
    assert not red[80:].any()
    assert not red[:, 80:].any()


def test_lamps_light_the_scene(gl: None) -> None:
    floor = Face((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (6.0, 6.0), 0, Truth.FLOOR)
    scene = Scene(YARD, (floor,), (), (np.full((8, 8, 3), 200, np.uint8),))
    with rendering.SceneRenderer(scene, 64, 48, 50.0) as renderer:
        means = []
        for factor in (0.0, 0.5, 1.0):
            renderer.set_lamps(np.full(3, factor))
            means.append(renderer.colour(np.array((-3.0, 0, 1)), LOOKING_NORTH)[30:].mean())
    assert means[0] < means[1] < means[2]


def test_axes_of_a_drone_that_yaws_rolls_and_pitches() -> None:
    east = optical_axes(np.array((0, 0, np.pi / 2)), np.zeros(3))
    np.testing.assert_allclose(east[:, 2], (0, -1, 0), atol=1e-12)  # looks east = minus west
    rolled = optical_axes(np.array((0.2, 0, 0)), np.zeros(3))
    assert rolled[2, 0] == pytest.approx(-np.sin(0.2))  # right wing down
    nose_up = optical_axes(np.array((0, 0.3, 0)), np.array((0, -0.1, 0)))
    assert nose_up[2, 2] == pytest.approx(np.sin(0.2))  # the mount looks down


@pytest.mark.parametrize("loads", ["libOSMesa.so.8 libOpenGL.so.0", ""])
def test_without_egl_osmesa_or_a_clear_line(loads: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("MUJOCO_GL", raising=False)
    monkeypatch.setattr(rendering, "_loads", lambda library: library in loads.split())
    if loads:
        assert rendering.choose_backend() == "osmesa"
    else:
        with pytest.raises(InputError, match="libegl1"):
            rendering.choose_backend()


def test_the_embedded_set_needs_no_renderer() -> None:
    code = (
        "import sys, horizon_dl.simulation.embedded as e; e.embedded_set(); sys.exit('mujoco' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


# Writing a set


def test_a_seed_stands_for_a_set(gl: None, tmp_path: Path) -> None:
    for name in ("a", "again"):
        simulate(tmp_path / name, frames=2, seed=3, width=96, height=72)
    for part in ("frames.csv", "camera.yaml", "images/00001.jpg", "labels/00001.png", "depth/00001.png"):
        assert (tmp_path / "a" / part).read_bytes() == (tmp_path / "again" / part).read_bytes()
    frame = open_recording(tmp_path / "a").read(0)
    assert frame.image.shape == (72, 96, 3)
    assert frame.camera.cx == 47.5
    assert set(np.unique(frame.truth)) <= {1, 2, 3}


@pytest.mark.parametrize("world", WORLDS)
def test_seeds_differ(world: str) -> None:
    first, second = (WORLDS[world].draw(np.random.default_rng(seed)) for seed in (3, 4))
    assert first.length_m != second.length_m
    assert not set(first.solids) & set(second.solids)


@pytest.mark.parametrize(("field", "value"), [("frames", 1), ("width", 8), ("height", 9999), ("quality", 0)])
def test_numbers_out_of_range(field: str, value: int, tmp_path: Path) -> None:
    numbers = {"frames": 3, "seed": 0, field: value}
    with pytest.raises(InputError, match=f"{field} is {value}"):
        simulate(tmp_path / "set", **numbers)
    assert not list(tmp_path.iterdir())


def test_never_writes_over_a_folder_in_use(tmp_path: Path) -> None:
    (tmp_path / "mine.txt").write_text("mine")
    with pytest.raises(InputError, match="not an empty folder"):
        simulate(tmp_path, frames=3, seed=0)
    assert [path.name for path in tmp_path.iterdir()] == ["mine.txt"]


def test_nothing_half_rendered_stays(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def breaks_off(*_: object) -> object:
        picture, zeros = np.zeros((4, 4, 3), np.uint8), np.zeros((4, 4))
        yield Shot(picture, zeros.astype(np.uint8), zeros, 0.0, np.zeros(3), np.zeros(3))
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(simulate_module, "render_flight", breaks_off)
    with pytest.raises(InputError, match="No space left"):
        simulate(tmp_path / "set", frames=3, seed=0)
    assert not list(tmp_path.iterdir())


# Worlds and flights


@pytest.mark.parametrize("world", WORLDS)
@pytest.mark.parametrize("seed", range(3))
def test_flights_keep_clear_of_everything(world: str, seed: int) -> None:
    rng = np.random.default_rng(seed)
    rig = WORLDS[world].rig(rng)
    arena, flight = fitting_flight(rng, WORLDS[world].draw(rng), 40.0, rig.height_m)
    assert len(arena.solids) >= 6
    for x, y in flight.place[::40, :2]:  # outlines traced point by point, not by the planner's own formula
        for solid in arena.solids:
            corners = np.array([(a, b) for a in np.linspace(-1, 1, 21) for b in (-1.0, 1.0)])
            corners = np.vstack((corners, corners[:, ::-1])) * (solid.half_x, solid.half_y)
            turn = np.exp(1j * solid.turn_rad) * (corners[:, 0] + 1j * corners[:, 1])
            if solid.kind == "pole":
                turn = solid.half_x * np.exp(1j * np.linspace(0, 2 * np.pi, 40))
            assert np.abs(turn + solid.x + 1j * solid.y - (x + 1j * y)).min() >= CLEARANCE_M
        assert arena.length_m / 2 - abs(x) >= CLEARANCE_M
        assert arena.width_m / 2 - abs(y) >= CLEARANCE_M
    low, high = rig.height_m
    assert low <= flight.place[:, 2].min() <= flight.place[:, 2].max() <= high
    assert np.ptp(flight.place[:, 2]) > 0.4 * (high - low)


def test_tilt_goes_with_acceleration() -> None:
    rng = np.random.default_rng(1)
    _, flight = fitting_flight(rng, WORLDS["arena"].draw(rng), 60.0, DRONE.height_m)
    acceleration = np.gradient(np.gradient(flight.place[:, :2], axis=0), axis=0) * RATE_HZ**2
    roll, pitch, yaw = flight.rpy_rad.T
    north, east = acceleration[:, 0], -acceleration[:, 1]
    assert np.corrcoef(roll, -north * np.sin(yaw) + east * np.cos(yaw))[0, 1] > 0.8
    assert np.corrcoef(-pitch, north * np.cos(yaw) + east * np.sin(yaw))[0, 1] > 0.6
    assert np.rad2deg(roll.std()) > 2
    assert np.abs(np.diff(yaw)).max() * RATE_HZ < np.deg2rad(250)  # no jumps


ROOMS = (*AT_WALLS, *INDOORS, *IN_A_HALLWAY, *AT_OFFICE_WALLS, *IN_AN_OFFICE, *ABOUT_AN_OFFICE)
DRAWS = (*ROOMS, *OUTDOORS, *ON_A_PAVEMENT)


@pytest.mark.parametrize("draw", sorted({draw for _, draw in DRAWS}, key=str))
def test_parts_of_things_lie_within_their_outline(draw: Callable[[np.random.Generator], Solid]) -> None:
    """A flight keeps clear of outlines alone; but one flies under the crowns of trees."""
    for seed in range(20):
        solid = draw(np.random.default_rng(seed))
        for part in solid.parts:
            assert 0 <= part.low_m < part.high_m <= solid.height_m
            if solid.kind == "shelf" and part.surface == "box":
                assert abs(part.y) + part.half_y < solid.half_y - 0.02  # between its sides
            if solid.kind != "tree" or part.low_m == 0:
                assert abs(part.x) + part.half_x <= solid.half_x + 1e-9
                assert abs(part.y) + part.half_y <= solid.half_y + 1e-9


def test_an_office_is_crowded_and_white_grey_and_black() -> None:
    rng = np.random.default_rng(0)
    offices = [WORLDS["office"].draw(rng) for _ in range(8)]
    desks = [sum(solid.kind.startswith("desk") for solid in office.solids) for office in offices]
    colours = [part.colour for office in offices for solid in office.solids for part in solid.bodies]
    assert min(desks) >= 1
    assert np.mean(desks) > 2
    assert np.mean([len(office.solids) for office in offices]) > 12
    assert np.isin(colours, (*MUTED, "blue")).mean() > 0.7
    for office in offices:
        textures: list[np.ndarray] = []
        list(wall_faces(rng, office, textures))
        red, _, blue = textures[0].reshape(-1, 3).mean(axis=0)
        assert abs(red - blue) < 0.4 * red  # white, grey or beige: no coloured wall


@pytest.mark.parametrize("sun_deg", [12.0, 45.0])
def test_shadows_by_walking_up_the_ray(sun_deg: float) -> None:
    """Against a walk in small steps, through parts that stand and that float."""
    rng = np.random.default_rng(4)
    towards = np.array((np.cos(1.0), np.sin(1.0))) / np.tan(np.deg2rad(sun_deg))
    points = rng.uniform(-6, 6, (3000, 2))
    post_and_roof = (
        Part(0.1, -0.2, 0.05, 0.05, 0.0, 2.0, "grey"),
        Part(0.3, 0.4, 0.8, 0.5, 1.5, 2.1, "grey"),
    )
    solid = Solid("shed", 0.5, -0.3, 0.7, 1.2, 1.0, 2.1, "grey", post_and_roof)
    walked = np.zeros(len(points), bool)
    for up_m in np.arange(0.0, 2.2, 0.002):
        spot = points + up_m * towards - (solid.x, solid.y)
        turned = spot[:, 0] + 1j * spot[:, 1]
        turned = turned * np.exp(-1j * solid.turn_rad)
        for part in solid.parts:
            inside = (np.abs(turned.real - part.x) < part.half_x) & (
                np.abs(turned.imag - part.y) < part.half_y
            )
            walked |= inside & (part.low_m <= up_m <= part.high_m)
    assert 0.01 < walked.mean() < 0.9
    assert (solid.shades(points, towards) == walked).mean() > 0.998


def test_furniture_stands_with_its_back_at_a_wall() -> None:
    rng, sides = np.random.default_rng(0), set()
    for _ in range(40):
        solid = at_a_wall(rng, shelf(rng), YARD)
        assert solid is not None
        back = np.array((solid.x, solid.y)) - solid.half_x * np.array(
            (np.cos(solid.turn_rad), np.sin(solid.turn_rad))
        )
        assert np.abs(back).max() == pytest.approx(6.0 - 0.05)
        sides.add((int(np.abs(back).argmax()), bool(back[np.abs(back).argmax()] > 0)))
    assert len(sides) == 4


def test_what_stands_beside_a_street_leaves_the_way_free() -> None:
    """Longer sides along it, both sides of it, nothing in anything else."""
    rng, sides = np.random.default_rng(0), set()
    for _ in range(30):
        for draw in (hedge, car):
            solid = beside_the_way(rng, draw(rng), YARD, 1.5)
            assert solid is not None
            assert abs(abs(solid.y) - 4.5) < 1e-9
            longest = 1j * (solid.half_y > solid.half_x) + (solid.half_x >= solid.half_y)
            assert abs((longest * np.exp(1j * solid.turn_rad)).imag) < 1e-9
            sides.add(bool(solid.y > 0))
    assert sides == {False, True}
    full = replace(YARD, solids=(replace(car(rng), half_x=6.0, half_y=6.0),))
    assert beside_the_way(rng, hedge(rng), full, 1.5) is None


def test_a_floor_that_shines_shows_what_stands_on_it_and_stays_floor(gl: None) -> None:
    """An orange box: its mirror image below its foot is orange, too, and the label there is floor."""
    box = Solid("box", 3.0, 0.0, 0.0, 0.5, 0.5, 1.0, "orange")
    hall = Arena(10.0, 6.0, 3.0, False, ("grey", "grey", "grey"), (box,), "lino")
    found = {}
    for shine in (0.0, 0.5):
        scene = build_scene(np.random.default_rng(0), replace(hall, shine=shine))
        with rendering.SceneRenderer(scene, 160, 120, 100.0) as renderer:
            place, axes = np.array((0.0, 0.0, 0.8)), LOOKING_NORTH
            found[shine] = (renderer.colour(place, axes).astype(float), renderer.truth(place, axes)[0])
    np.testing.assert_array_equal(found[0.0][1], found[0.5][1])
    foot = 60 + round(0.8 / 2.5 * 100)
    below = np.s_[foot + 2 : foot + 8, 76:84]
    assert (found[0.5][1][below] == Truth.FLOOR).all()
    red = {shine: (image[below][..., 0] - image[below][..., 2]).mean() for shine, (image, _) in found.items()}
    assert red[0.5] > red[0.0] + 15


@pytest.mark.parametrize("world", [name for name in WORLDS if name != "arena"])
def test_other_worlds_agree_with_the_geometry_too(world: str, gl: None, tmp_path: Path) -> None:
    """Depth, labels, camera file with its own lens and mount, attitude and the project's own geometry."""
    lenses = set()
    for seed in (1, 2):
        simulate(tmp_path / str(seed), frames=3, seed=seed, world=world, width=160, height=120)
        recording = open_recording(tmp_path / str(seed))
        camera = yaml.safe_load((tmp_path / str(seed) / "camera.yaml").read_text())
        lenses.add((camera["fx"], camera["mount_rpy_deg"][1]))
        for index in range(3):
            frame = recording.read(index)
            stem = Path(frame.name).stem
            labels = np.array(Image.open(tmp_path / str(seed) / "labels" / f"{stem}.png"))
            depth = np.array(Image.open(tmp_path / str(seed) / "depth" / f"{stem}.png"))
            height = pixel_rays(160, 120, frame.camera.fx) * depth[..., None] / 1000.0 @ frame.up_cam
            assert np.abs(height[labels == Truth.FLOOR] + frame.height_m).max() < 0.004
            assert height[labels == Truth.OBSTACLE].min() > -frame.height_m - 0.004
            # The sky has no depth; a ceiling lies over the camera.
            assert (height[labels == Truth.ABOVE] >= 0).all()
    assert all(len(set(values)) == 2 for values in zip(*lenses, strict=True))


def test_every_kind_of_world_has_its_words() -> None:
    assert list(KINDS) == list(WORLDS)


def test_a_world_that_there_is_not(tmp_path: Path) -> None:
    with pytest.raises(
        InputError, match=r"no world 'moon'.*arena, clutter, hallway, office, outdoor, street"
    ):
        simulate(tmp_path / "set", frames=3, seed=0, world="moon")
    assert not list(tmp_path.iterdir())


def test_distance_to_solids_by_hand() -> None:
    box = Solid("box", 1.0, 0.0, np.pi / 2, 0.5, 0.2, 1.0, "grey")  # turned: 0.2 along x, 0.5 along y
    found = box.distance(np.array([(0.0, 0.0), (1.0, 0.1), (1.2 + 3, 0.5 + 4)]))
    np.testing.assert_allclose(found, (0.8, 0.0, 5.0), atol=1e-12)
    pole = Solid("pole", 0.0, 2.0, 0.0, 0.1, 0.1, 2.5, "grey")
    np.testing.assert_allclose(pole.distance(np.array([(3.0, 6.0)])), 4.9)


# Noise and sensor


def test_noise_is_periodic_smooth_and_bounded() -> None:
    field = value_noise(np.random.default_rng(0), 64, 96, (4, 6))
    assert field.shape == (64, 96)
    assert 0 <= field.min() < field.max() <= 1
    wrapped = np.abs(field - np.roll(field, 1, axis=1)).max(axis=0)
    assert wrapped[0] < 2.5 * wrapped[1:].max()  # no seam where it repeats


def test_exposure_settles_on_its_target() -> None:
    exposure = AutoExposure(gain=5.0)
    for _ in range(60):
        exposure.follow(0.05)
    assert 0.05 * exposure.gain == pytest.approx(TARGET**GAMMA, rel=0.02)


def test_more_gain_is_brighter_and_noise_is_noise() -> None:
    grey = np.full((60, 80, 3), 0.1, np.float32)
    dark, bright = (develop(np.random.default_rng(0), grey, gain, np.ones(3), 1.0) for gain in (0.5, 2.0))
    assert dark.mean() + 20 < bright.mean()
    assert 1 < dark.std() < 12
    clean = develop(np.random.default_rng(0), grey, 1.0, np.ones(3), 0.0)
    assert np.ptp(clean) == 0
    assert clean[0, 0, 0] == pytest.approx(255 * 0.106 ** (1 / GAMMA), abs=1.5)

"""Rays and projection against OpenCV, NumPy in float64 and each other."""

import time

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from horizon_dl.geometry.camera import Camera
from horizon_dl.geometry.lenses.inverse import invert_odd_polynomial
from horizon_dl.geometry.rays import camera_rays, project, unproject

PINHOLE = Camera("pinhole", 640, 480, 537.6, 539.0, 315.1, 244.5)
BEBOP = Camera(
    "radtan", 520, 240, 323.93, 323.97, 262.3, 213.96, (-0.33786, 0.13481, -0.00011, 0.00044, -0.02786)
)
NANO = Camera(
    "radtan",
    640,
    480,
    210.2412,
    211.4847,
    318.5118,
    252.4846,
    (0.199416, -0.207364, 0.000704, 0.000806, 0.047875),
)
EUROC = Camera(
    "radtan",
    752,
    480,
    458.654,
    457.296,
    367.215,
    248.375,
    (-0.28340811, 0.07395907, 0.00019359, 1.76e-05, 0.0),
)
FISHEYE = Camera("kannala_brandt", 640, 480, 190.0, 191.0, 318.0, 242.0, (-0.01, 0.004, -0.003, 0.0005))
CAMERAS = [PINHOLE, BEBOP, NANO, EUROC, FISHEYE]
IDS = ["pinhole", "bebop", "nano", "euroc", "fisheye"]


def matrix(camera: Camera) -> np.ndarray:
    return np.array([[camera.fx, 0, camera.cx], [0, camera.fy, camera.cy], [0, 0, 1]], dtype=np.float64)


def opencv_project(camera: Camera, points: np.ndarray) -> np.ndarray:
    zero = np.zeros(3)
    if camera.model == "kannala_brandt":
        pixels, _ = cv2.fisheye.projectPoints(
            points[:, None], zero, zero, matrix(camera), np.array(camera.distortion)
        )
    else:
        pixels, _ = cv2.projectPoints(
            points, zero, zero, matrix(camera), np.array(camera.distortion or (0.0,) * 5)
        )
    return pixels.reshape(-1, 2)


@pytest.mark.parametrize("camera", CAMERAS, ids=IDS)
def test_projection_agrees_with_opencv(camera: Camera) -> None:
    points = np.random.default_rng(0).uniform([-0.8, -0.6, 1.0], [0.8, 0.6, 3.0], (200, 3))
    np.testing.assert_allclose(project(camera, points), opencv_project(camera, points), atol=1e-6)


@pytest.mark.parametrize("camera", CAMERAS, ids=IDS)
def test_rays_return_to_their_pixels_through_opencv(camera: Camera) -> None:
    rays = camera_rays(camera)
    picked = rays.valid & (rays.directions[..., 2] > 0.1)
    v, u = np.nonzero(picked)
    back = opencv_project(camera, rays.directions[picked].astype(np.float64))
    # float32 directions limit this to about 1e-4 px.
    np.testing.assert_allclose(back, np.stack([u, v], axis=-1), atol=2e-3)


@pytest.mark.parametrize("camera", CAMERAS, ids=IDS)
def test_rays_are_unit_and_valid_nearly_everywhere(camera: Camera) -> None:
    rays = camera_rays(camera)
    assert rays.directions.shape == (camera.height, camera.width, 3)
    assert rays.directions.dtype == np.float32
    assert rays.valid.mean() > 0.95
    assert np.isnan(rays.directions[~rays.valid]).all()
    np.testing.assert_allclose(np.linalg.norm(rays.directions[rays.valid], axis=-1), 1.0, atol=1e-6)


@pytest.mark.parametrize("camera", [BEBOP, NANO, EUROC], ids=["bebop", "nano", "euroc"])
def test_inverse_agrees_with_opencvs_on_the_central_part(camera: Camera) -> None:
    rng = np.random.default_rng(1)
    plane = rng.uniform(-0.45, 0.45, (300, 2))
    pixels = opencv_project(camera, np.c_[plane, np.ones(300)])
    theirs = cv2.undistortPoints(pixels[:, None], matrix(camera), np.array(camera.distortion)).reshape(-1, 2)
    directions, valid = unproject(camera, pixels)
    assert valid.all()
    ours = directions[:, :2] / directions[:, 2:]
    np.testing.assert_allclose(ours, plane, atol=1e-8)
    np.testing.assert_allclose(ours, theirs, atol=5e-3)  # OpenCV stops after five iterations


def test_fisheye_inverse_agrees_with_opencv() -> None:
    turn, radius = np.random.default_rng(2).uniform([0, 0], [2 * np.pi, 235], (200, 2)).T  # to 70 degrees
    pixels = np.stack([318 + radius * np.cos(turn), 242 + radius * np.sin(turn)], axis=-1)
    theirs = cv2.fisheye.undistortPoints(pixels[:, None], matrix(FISHEYE), np.array(FISHEYE.distortion))
    directions, valid = unproject(FISHEYE, pixels)
    assert valid.all()
    np.testing.assert_allclose(
        directions[:, :2] / directions[:, 2:], theirs.reshape(-1, 2), atol=1e-5, rtol=1e-5
    )


def test_fisheye_sees_behind_ninety_degrees() -> None:
    equidistant = Camera("kannala_brandt", 401, 401, 100.0, 100.0, 200.0, 200.0, (0.0, 0.0, 0.0, 0.0))
    directions, valid = unproject(equidistant, [[200.0 + 100.0 * np.pi * 0.6, 200.0]])
    assert valid.all()
    np.testing.assert_allclose(directions[0], [np.sin(np.pi * 0.6), 0.0, np.cos(np.pi * 0.6)], atol=1e-9)


def test_pinhole_ray_by_hand() -> None:
    directions, _ = unproject(Camera("pinhole", 640, 480, 500.0, 250.0, 320.0, 240.0), [[820.0, 490.0]])
    np.testing.assert_allclose(directions[0], np.array([1.0, 1.0, 1.0]) / np.sqrt(3.0))


def test_a_lens_that_folds_over_is_masked_there() -> None:
    # r (1 - 0.5 r^2) grows up to r = sqrt(2 / 3) only, where it is 0.5443.
    folding = Camera("radtan", 401, 401, 200.0, 200.0, 200.0, 200.0, (-0.5, 0.0, 0.0, 0.0, 0.0))
    rays = camera_rays(folding)
    v, u = np.mgrid[:401, :401]
    radius = np.hypot(u - 200.0, v - 200.0) / 200.0
    assert rays.valid[radius < 0.54].all()
    assert not rays.valid[radius > 0.545].any()
    tangent = np.hypot(rays.directions[..., 0], rays.directions[..., 1]) / rays.directions[..., 2]
    assert np.nanmax(tangent) <= np.sqrt(2 / 3) + 1e-6


def test_points_behind_a_camera_have_no_pixel() -> None:
    assert np.isnan(project(PINHOLE, [[0.1, 0.2, -1.0]])).all()


def test_rays_are_computed_once_and_cannot_be_written() -> None:
    camera_rays(BEBOP)
    begin = time.perf_counter()
    rays = camera_rays(BEBOP)
    assert time.perf_counter() - begin < 0.01
    with pytest.raises(ValueError, match="read-only"):
        rays.directions[0, 0, 0] = 1.0


def test_scaled_camera_keeps_the_ray_of_a_point() -> None:
    half = EUROC.scaled(376, 240)
    points = np.random.default_rng(3).uniform([-0.5, -0.3, 1.0], [0.5, 0.3, 1.0], (50, 3))
    np.testing.assert_allclose((project(EUROC, points) + 0.5) / 2 - 0.5, project(half, points), atol=1e-9)


@settings(max_examples=40, deadline=None)
@given(
    k1=st.floats(-0.4, 0.4),
    k2=st.floats(-0.2, 0.2),
    p1=st.floats(-0.003, 0.003),
    p2=st.floats(-0.003, 0.003),
    k3=st.floats(-0.05, 0.05),
)
def test_every_valid_ray_projects_to_its_pixel(k1: float, k2: float, p1: float, p2: float, k3: float) -> None:
    camera = Camera("radtan", 64, 48, 40.0, 41.0, 31.0, 24.5, (k1, k2, p1, p2, k3))
    rays = camera_rays(camera)
    v, u = np.nonzero(rays.valid)
    assert rays.valid[24, 31]
    x, y = (rays.directions[rays.valid][:, :2] / rays.directions[rays.valid][:, 2:]).astype(np.float64).T
    r2 = x * x + y * y
    radial = 1 + k1 * r2 + k2 * r2**2 + k3 * r2**3  # Brown's model, as OpenCV's manual writes it
    distorted_x = x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x)
    distorted_y = y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y
    near = r2 < 25  # float32 directions lose a pixel's hundredth beyond 79 degrees off axis
    np.testing.assert_allclose((40.0 * distorted_x + 31.0)[near], u[near], atol=0.02)
    np.testing.assert_allclose((41.0 * distorted_y + 24.5)[near], v[near], atol=0.02)


def test_polynomial_inverse_by_hand() -> None:
    s, found, limit = invert_odd_polynomial((-1.0 / 3.0,), np.array([0.0, 0.5 - 0.125 / 3, 0.7]), 5.0)
    assert limit == pytest.approx(1.0)
    np.testing.assert_allclose(s[:2], [0.0, 0.5], atol=1e-9)
    assert found.tolist() == [True, True, False]  # the largest value reached is 2/3

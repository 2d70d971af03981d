"""Lens models against OpenCV, kornia, the papers' formulas written out in NumPy, and their own inverses."""

import math
import subprocess
import sys
from collections.abc import Callable

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from horizon_dl.geometry.camera import Camera
from horizon_dl.geometry.lenses.registry import LENSES
from horizon_dl.geometry.rays import camera_rays, project, unproject

Floats = NDArray[np.float64]
RATIONAL = (0.93, 0.166, -2.4e-05, -1.4e-05, 0.0029, 1.33, 0.436, 0.0276)  # an Azure Kinect's
LENS_VALUES: dict[str, tuple[float, ...]] = {
    "pinhole": (),
    "radtan": (-0.28, 0.07, 0.0002, 1.8e-05, 0.0),
    "rational": RATIONAL,
    "kannala_brandt": (-0.00927, 0.04619, -0.0434, 0.00802),
    "double_sphere": (-0.2, 0.59),
    "eucm": (0.63, 1.04),
    "omni": (1.2, -0.1, 0.05, 0.0005, -0.0003),
    "fov": (0.92,),
}


def camera(lens: str, width: int = 320, height: int = 240) -> Camera:
    return Camera(lens, width, height, 160.0, 161.0, 158.3, 121.7, LENS_VALUES[lens])


def directions(count: int, widest_rad: float, seed: int = 0) -> Floats:
    """Unit vectors up to an angle off the axis, of lengths from 0.5 to 3."""
    rng = np.random.default_rng(seed)
    angle, turn = rng.uniform(0, widest_rad, count), rng.uniform(0, 2 * np.pi, count)
    unit = np.stack([np.sin(angle) * np.cos(turn), np.sin(angle) * np.sin(turn), np.cos(angle)], -1)
    return np.asarray(unit * rng.uniform(0.5, 3.0, (count, 1)))


def by_double_sphere(point: Floats) -> Floats:
    """Usenko et al. 2018, equations 40 to 42."""
    (x, y, z), (xi, alpha) = point, LENS_VALUES["double_sphere"]
    d1 = math.sqrt(x**2 + y**2 + z**2)
    d2 = math.sqrt(x**2 + y**2 + (xi * d1 + z) ** 2)
    return np.array([x, y]) / (alpha * d2 + (1 - alpha) * (xi * d1 + z))


def by_eucm(point: Floats) -> Floats:
    """Khomutenko et al. 2016, equation 5."""
    (x, y, z), (alpha, beta) = point, LENS_VALUES["eucm"]
    rho = math.sqrt(beta * (x**2 + y**2) + z**2)
    return np.array([x, y]) / (alpha * rho + (1 - alpha) * z)


def by_omni(point: Floats) -> Floats:
    """Mei and Rives 2007, section II."""
    xi, k1, k2, p1, p2 = LENS_VALUES["omni"]
    xs, ys, zs = point / np.linalg.norm(point)
    x, y = xs / (zs + xi), ys / (zs + xi)
    r2 = x * x + y * y
    radial = 1 + k1 * r2 + k2 * r2 * r2
    return np.array(
        [
            x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x),
            y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y,
        ]
    )


def by_fov(point: Floats) -> Floats:
    """Devernay and Faugeras 2001, equation 13."""
    (omega,) = LENS_VALUES["fov"]
    plane = point[:2] / point[2]
    radius = float(np.linalg.norm(plane))
    return np.asarray(plane * math.atan(2 * radius * math.tan(omega / 2)) / omega / radius)


@pytest.mark.parametrize(
    ("lens", "formula", "widest_deg"),
    [
        ("double_sphere", by_double_sphere, 100),
        ("eucm", by_eucm, 95),
        ("omni", by_omni, 100),
        ("fov", by_fov, 80),
    ],
)
def test_the_papers_formulas(lens: str, formula: Callable[[Floats], Floats], widest_deg: float) -> None:
    points = directions(300, math.radians(widest_deg))
    one = camera(lens)
    wanted = [np.array([160.0, 161.0]) * formula(point) + [158.3, 121.7] for point in points]
    np.testing.assert_allclose(project(one, points), wanted, atol=1e-9)


def test_rational_is_opencvs() -> None:
    one, points = camera("rational"), directions(300, math.radians(65))
    matrix = np.array([[one.fx, 0, one.cx], [0, one.fy, one.cy], [0, 0, 1]])
    theirs, _ = cv2.projectPoints(points, np.zeros(3), np.zeros(3), matrix, np.array(RATIONAL))
    np.testing.assert_allclose(project(one, points), theirs.reshape(-1, 2), atol=1e-8)
    ours, valid = unproject(one, theirs.reshape(-1, 2))
    assert valid.all()
    np.testing.assert_allclose(ours, points / np.linalg.norm(points, axis=-1, keepdims=True), atol=1e-8)


@pytest.mark.parametrize("lens", ["radtan", "kannala_brandt"])
def test_kornia_says_the_same(lens: str) -> None:
    import torch
    from kornia.geometry.calibration import distort_points
    from kornia.geometry.camera import distort_points_kannala_brandt

    one, points = camera(lens), directions(200, math.radians(40))
    plane = torch.from_numpy(points[:, :2] / points[:, 2:])
    values = torch.tensor(one.distortion, dtype=torch.float64)
    matrix = torch.tensor([[one.fx, 0, one.cx], [0, one.fy, one.cy], [0, 0, 1]], dtype=torch.float64)
    affine = torch.tensor([one.fx, one.fy, one.cx, one.cy], dtype=torch.float64)
    if lens == "radtan":
        theirs = distort_points(plane * affine[:2] + affine[2:], matrix, values)
    else:
        theirs = distort_points_kannala_brandt(plane, torch.cat([affine, values]).expand(len(plane), -1))
    np.testing.assert_allclose(project(one, points), theirs.numpy(), atol=1e-8)


@pytest.mark.parametrize("lens", LENSES)
def test_rays_return_to_their_pixels(lens: str) -> None:
    one = camera(lens)
    rays = camera_rays(one)
    assert rays.valid.mean() > 0.95
    v, u = np.nonzero(rays.valid)
    pixels = np.stack([u, v], -1).astype(np.float64)
    exact, valid = unproject(one, pixels)
    assert valid.all()
    np.testing.assert_allclose(np.linalg.norm(exact, axis=-1), 1.0, atol=1e-12)
    np.testing.assert_allclose(project(one, exact), pixels, atol=1e-3)
    assert np.isnan(rays.directions[~rays.valid]).all()


@pytest.mark.parametrize("lens", LENSES)
def test_a_scaled_camera_keeps_its_rays(lens: str) -> None:
    one = camera(lens)
    points = directions(100, math.radians(40))
    for width, height in ((160, 120), (640, 480), (100, 200)):
        other = project(one.scaled(width, height), points)
        scale = np.array([width / 320, height / 240])
        np.testing.assert_allclose((project(one, points) + 0.5) * scale - 0.5, other, atol=1e-9)


@pytest.mark.parametrize("lens", ["kannala_brandt", "double_sphere", "eucm", "omni"])
def test_wide_lenses_see_behind_ninety_degrees(lens: str) -> None:
    one = Camera(lens, 640, 480, 100.0, 100.0, 320.0, 240.0, LENS_VALUES[lens])
    points = directions(200, math.radians(95), seed=3)
    points /= np.linalg.norm(points, axis=-1, keepdims=True)
    points = points[points[:, 2] < 0.2]
    back, valid = unproject(one, project(one, points))
    assert valid.all()
    np.testing.assert_allclose(back, points, atol=1e-6)
    assert (points[:, 2] < 0).any()


@pytest.mark.parametrize("lens", ["pinhole", "radtan", "rational", "fov"])
def test_what_lies_behind_has_no_pixel(lens: str) -> None:
    assert np.isnan(project(camera(lens), [[0.1, 0.2, -1.0], [0.1, 0.2, 0.0]])).all()


values = st.floats(-0.3, 0.3)


def round_trip(lens: str, lens_values: tuple[float, ...]) -> None:
    """Every valid ray goes back to its pixel, and the middle of the image has one."""
    one = Camera(lens, 64, 48, 40.0, 41.0, 31.0, 24.5, lens_values)
    v, u = np.mgrid[:48, :64]
    pixels = np.stack([u.ravel(), v.ravel()], -1).astype(np.float64)
    rays, valid = unproject(one, pixels)
    assert valid[24 * 64 + 31]
    assert np.abs(project(one, rays[valid]) - pixels[valid]).max() < 1e-2
    # The inner branch is one to one: no two pixels share a ray.
    assert len(np.unique(rays[valid].round(9), axis=0)) == valid.sum()


@settings(max_examples=30, deadline=None)
@given(
    k=st.tuples(
        values, values, st.floats(-0.003, 0.003), st.floats(-0.003, 0.003), values, values, values, values
    )
)
def test_rational_round_trips(k: tuple[float, ...]) -> None:
    round_trip("rational", k)


@settings(max_examples=30, deadline=None)
@given(k=st.tuples(values, values, values, values))
def test_kannala_brandt_round_trips(k: tuple[float, ...]) -> None:
    round_trip("kannala_brandt", k)


@settings(max_examples=30, deadline=None)
@given(xi=st.floats(-0.9, 1.5), alpha=st.floats(0.0, 1.0))
def test_double_sphere_round_trips(xi: float, alpha: float) -> None:
    round_trip("double_sphere", (xi, alpha))


@settings(max_examples=30, deadline=None)
@given(alpha=st.floats(0.0, 1.0), beta=st.floats(0.1, 3.0))
def test_eucm_round_trips(alpha: float, beta: float) -> None:
    round_trip("eucm", (alpha, beta))


@settings(max_examples=30, deadline=None)
@given(xi=st.floats(0.0, 3.0), k1=values, k2=values)
def test_omni_round_trips(xi: float, k1: float, k2: float) -> None:
    round_trip("omni", (xi, k1, k2, 0.001, -0.001))


@settings(max_examples=20, deadline=None)
@given(omega=st.floats(0.01, 2.9))
def test_fov_round_trips(omega: float) -> None:
    round_trip("fov", (omega,))


def test_lenses_of_special_values_are_one_another() -> None:
    points = directions(100, math.radians(60))
    flat = Camera("pinhole", 320, 240, 160.0, 161.0, 158.3, 121.7)
    for lens, special in (("double_sphere", (0.0, 0.0)), ("eucm", (0.0, 1.0)), ("omni", (0.0, 0, 0, 0, 0))):
        same = Camera(lens, 320, 240, 160.0, 161.0, 158.3, 121.7, special)
        np.testing.assert_allclose(project(same, points), project(flat, points), atol=1e-9)


def test_geometry_needs_neither_torch_nor_opencv() -> None:
    code = (
        "import sys\n"
        "from horizon_dl.geometry.camera import Camera\n"
        "from horizon_dl.geometry.rays import camera_rays\n"
        "camera_rays(Camera('radtan', 64, 48, 40.0, 40.0, 31.5, 23.5, (-0.2, 0.0, 0.0, 0.0, 0.0)))\n"
        "bad = {'torch', 'kornia', 'cv2', 'scipy', 'skimage'} & set(sys.modules)\n"
        "assert not bad, bad\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True)

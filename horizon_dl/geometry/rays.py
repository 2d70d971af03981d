"""The ray of every pixel, computed once for a camera, and the way back from points to pixels.

The forward models are kornia's. Their inverse starts from the radial polynomial inverted on its inner branch
and is finished by Newton steps on the forward model itself: kornia's fixed-point inverse is far off for
strong lenses (kornia#4285). Every ray is projected again; pixels that do not return are not valid.
"""

from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from horizon_dl.geometry.camera import Camera

if TYPE_CHECKING:
    import torch

Floats = NDArray[np.float64]

MAX_ERROR_PX = 0.01
"""Largest distance between a pixel and the projection of its ray."""

NEWTON_STEPS = 12
NEWTON_ERROR_PX = 1e-7
MAX_TANGENT = 20.0  # 87 degrees: farther out a plane at z = 1 means little
MAX_ANGLE_RAD = np.pi


@dataclass(frozen=True)
class Rays:
    """Rays of all pixels of a camera.

    Attributes:
        directions: (h, w, 3) float32 unit vectors, optical frame; NaN where not valid.
        valid: (h, w) bool, the lens model could be inverted there to within `MAX_ERROR_PX`.
    """

    directions: NDArray[np.float32]
    valid: NDArray[np.bool_]


@lru_cache(maxsize=16)
def camera_rays(camera: Camera) -> Rays:
    """Rays through all pixel centres; computed once for each camera and kept (do not write into them)."""
    u, v = np.meshgrid(np.arange(camera.width, dtype=np.float64), np.arange(camera.height, dtype=np.float64))
    directions, valid = unproject(camera, np.stack([u.ravel(), v.ravel()], axis=-1))
    shape = (camera.height, camera.width)
    rays = Rays(directions.astype(np.float32).reshape(*shape, 3), valid.reshape(shape))
    rays.directions.setflags(write=False)
    rays.valid.setflags(write=False)
    return rays


def unproject(camera: Camera, pixels: ArrayLike) -> tuple[Floats, NDArray[np.bool_]]:
    """Unit rays (N, 3) of pixels (N, 2) in the optical frame and a mask (N,) of those that are valid.

    Rays that are not valid are NaN: no convergence, or beyond the radius where the lens polynomial folds
    over, so that two rays would meet in one pixel.
    """
    points = np.asarray(pixels, dtype=np.float64).reshape(-1, 2)
    normalised = (points - [camera.cx, camera.cy]) / [camera.fx, camera.fy]
    if camera.model == "kannala_brandt":
        directions, valid = _fisheye_directions(normalised, camera.distortion)
    else:
        plane, valid = normalised, np.ones(len(points), dtype=np.bool_)
        if camera.model == "radtan":
            plane, valid = _undistort_radtan(camera, points, normalised)
        directions = np.concatenate([plane, np.ones((len(plane), 1))], axis=-1)
        directions /= np.linalg.norm(directions, axis=-1, keepdims=True)
    in_front = directions[:, 2] > 1 / MAX_TANGENT
    back = project(camera, np.where(in_front[:, None], directions, [0.0, 0.0, 1.0]))
    error = np.linalg.norm(back - points, axis=-1)
    valid = valid & (
        ~in_front | (error < MAX_ERROR_PX)
    )  # behind the plane z = 1 the polynomial has been checked
    directions[~valid] = np.nan
    return directions, valid


def project(camera: Camera, points_cam: ArrayLike) -> Floats:
    """Pixels (N, 2) of points (N, 3) in the optical frame, any unit of length; NaN for points not in front.

    Example:
        >>> project(Camera("pinhole", 640, 480, 500.0, 500.0, 319.5, 239.5), [[0.1, 0.0, 1.0]]).tolist()
        [[369.5, 239.5]]
    """
    import torch

    points = np.asarray(points_cam, dtype=np.float64).reshape(-1, 3)
    depth = np.where(points[:, 2:] > 0, points[:, 2:], np.nan)
    pixels: Floats = _forward(camera, torch.from_numpy(points[:, :2] / depth)).numpy()
    return pixels


def _forward(camera: Camera, plane: "torch.Tensor") -> "torch.Tensor":
    """Pixels (N, 2) of points (N, 2) on the plane z = 1, by kornia, float64."""
    import torch
    from kornia.geometry.calibration import distort_points
    from kornia.geometry.camera import distort_points_affine, distort_points_kannala_brandt

    affine = torch.tensor([camera.fx, camera.fy, camera.cx, camera.cy], dtype=torch.float64)
    if camera.model == "kannala_brandt":
        lens = torch.cat([affine, torch.tensor(camera.distortion, dtype=torch.float64)])
        fisheye: torch.Tensor = distort_points_kannala_brandt(plane, lens.expand(len(plane), -1))
        return fisheye
    pixels: torch.Tensor = distort_points_affine(plane, affine.expand(len(plane), -1))
    if camera.model == "pinhole":
        return pixels
    matrix = torch.tensor(
        [[camera.fx, 0.0, camera.cx], [0.0, camera.fy, camera.cy], [0.0, 0.0, 1.0]], dtype=torch.float64
    )
    bent: torch.Tensor = distort_points(pixels, matrix, torch.tensor(camera.distortion, dtype=torch.float64))
    return bent


def _undistort_radtan(camera: Camera, pixels: Floats, normalised: Floats) -> tuple[Floats, NDArray[np.bool_]]:
    """Points (N, 2) on the plane z = 1 and where they lie on the inner branch of the model."""
    k1, k2, _, _, k3 = camera.distortion
    radius_distorted = np.linalg.norm(normalised, axis=-1)
    radius, valid, limit = invert_odd_polynomial((k1, k2, k3), radius_distorted, MAX_TANGENT)
    scale = np.where(radius_distorted > 1e-12, radius / np.maximum(radius_distorted, 1e-12), 1.0)
    plane, determinant = _newton(camera, pixels, normalised * scale[:, None])
    inner = (determinant > 0) & (np.linalg.norm(plane, axis=-1) < limit)
    return plane, valid & inner


def _newton(camera: Camera, pixels: Floats, plane: Floats) -> tuple[Floats, Floats]:
    """Newton steps on kornia's forward model with its derivative; also the Jacobian's determinant."""
    import torch

    target, x = torch.from_numpy(pixels), torch.from_numpy(plane)
    determinant = torch.ones(len(x), dtype=torch.float64)
    for _ in range(NEWTON_STEPS):
        x = x.detach().requires_grad_(True)
        image = _forward(camera, x)
        # Pixels do not depend on one another, so the gradient of a sum holds every pixel's own row.
        (row_u,) = torch.autograd.grad(image[:, 0].sum(), x, retain_graph=True)
        (row_v,) = torch.autograd.grad(image[:, 1].sum(), x)
        determinant = row_u[:, 0] * row_v[:, 1] - row_u[:, 1] * row_v[:, 0]
        error = image.detach() - target
        if float(error.abs().nan_to_num().max()) < NEWTON_ERROR_PX:
            break
        safe = torch.where(determinant.abs() > 1e-9, determinant, torch.full_like(determinant, torch.inf))
        step_x = (row_v[:, 1] * error[:, 0] - row_u[:, 1] * error[:, 1]) / safe
        step_y = (row_u[:, 0] * error[:, 1] - row_v[:, 0] * error[:, 0]) / safe
        x = x.detach() - torch.stack([step_x, step_y], dim=-1)
    return x.detach().numpy(), determinant.numpy()


def _fisheye_directions(
    normalised: Floats, distortion: tuple[float, ...]
) -> tuple[Floats, NDArray[np.bool_]]:
    """Unit rays (N, 3) of the Kannala-Brandt model (2006), also beyond 90 degrees off axis."""
    radius = np.linalg.norm(normalised, axis=-1)
    angle, valid, _ = invert_odd_polynomial(distortion, radius, MAX_ANGLE_RAD)
    sine_over_radius = np.where(radius > 1e-12, np.sin(angle) / np.maximum(radius, 1e-12), 1.0)
    return np.concatenate([normalised * sine_over_radius[:, None], np.cos(angle)[:, None]], axis=-1), valid


def invert_odd_polynomial(
    coefficients: tuple[float, ...], values: Floats, upper: float
) -> tuple[Floats, NDArray[np.bool_], float]:
    """Solve `s (1 + c0 s^2 + c1 s^4 + ...) = value` on the inner branch, where it grows from zero.

    Args:
        coefficients: c0, c1, ...
        values: (N,) not negative.
        upper: largest s that is looked for.

    Returns:
        (N,) s; (N,) whether it was found; the end of the inner branch.
    """
    odd = np.zeros(2 * len(coefficients) + 2)
    odd[1], odd[3::2] = 1.0, coefficients
    profile = np.polynomial.Polynomial(odd)
    slope = profile.deriv()
    limit = _first_turn(slope, upper)
    table = np.linspace(0.0, limit, 4096)
    s = np.interp(values, profile(table), table)
    for _ in range(6):
        gradient = slope(s)
        s = np.clip(
            s - (profile(s) - values) / np.where(np.abs(gradient) > 1e-6, gradient, np.inf), 0.0, limit
        )
    found = np.abs(profile(s) - values) < 1e-7 * (1 + values)
    return s, found & (s < limit), limit


def _first_turn(slope: np.polynomial.Polynomial, upper: float) -> float:
    """Where the slope first falls to zero in (0, upper], by a scan and bisection; upper if nowhere.

    A polynomial's roots from its companion matrix fail for vanishing leading coefficients.
    """
    table = np.linspace(0.0, upper, 4096)
    falling = np.flatnonzero(slope(table) <= 0)
    if not len(falling):
        return upper
    low, high = float(table[falling[0] - 1]), float(table[falling[0]])
    for _ in range(50):
        middle = (low + high) / 2
        low, high = (middle, high) if slope(middle) > 0 else (low, middle)
    return low

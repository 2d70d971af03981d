"""How the camera turned between two pictures, from the pictures alone."""

import math

import numpy as np
from numpy.typing import NDArray

from horizon_dl.geometry.camera import Camera
from horizon_dl.geometry.rays import unproject

Floats = NDArray[np.float64]
Gray = NDArray[np.uint8]

CORNERS = 400
SEARCHED = (21, 21)
LEAST_TRACKS = 25
ROUND_TRIP_PX = 1.0
INLIER_PX = 1.5
DRAWS = 60


def tracked(first: Gray, second: Gray) -> tuple[Floats, Floats]:
    """Pixels (N, 2) of corners in one picture and where they are found in the other, there and back again.

    Pyramidal Lucas-Kanade; where the picture moved too far for it, matched ORB features.
    """
    import cv2

    corners = cv2.goodFeaturesToTrack(first, CORNERS, 0.01, max(4.0, first.shape[1] / 60))
    if corners is not None and len(corners) >= LEAST_TRACKS:
        there, found, _ = cv2.calcOpticalFlowPyrLK(first, second, corners, None, winSize=SEARCHED, maxLevel=4)
        back, again, _ = cv2.calcOpticalFlowPyrLK(second, first, there, None, winSize=SEARCHED, maxLevel=4)
        good = (found & again).ravel().astype(bool)
        good &= np.linalg.norm((back - corners).reshape(-1, 2), axis=-1) < ROUND_TRIP_PX
        if good.sum() >= max(LEAST_TRACKS, 0.3 * len(corners)):
            pair = corners.reshape(-1, 2)[good], there.reshape(-1, 2)[good]
            return pair[0].astype(np.float64), pair[1].astype(np.float64)
    return _matched(first, second)


def _matched(first: Gray, second: Gray) -> tuple[Floats, Floats]:
    import cv2

    detector = cv2.ORB.create(2 * CORNERS, fastThreshold=7)
    (one, described), (other, redescribed) = (
        detector.detectAndCompute(image, None) for image in (first, second)
    )
    if described is None or redescribed is None:
        return np.zeros((0, 2)), np.zeros((0, 2))
    matches = cv2.BFMatcher(cv2.NORM_HAMMING, crossCheck=True).match(described, redescribed)
    pairs = [(one[m.queryIdx].pt, other[m.trainIdx].pt) for m in matches if m.distance < 64]
    array = np.array(pairs, np.float64).reshape(-1, 2, 2)
    return array[:, 0], array[:, 1]


def rotation_between(camera: Camera, first: Gray, second: Gray) -> Floats | None:
    """Rotation (3, 3) that takes directions in the first optical frame to the second; None if not told.

    The camera may travel as well: where the pictures' shift is no rotation alone, the essential matrix is
    fitted (Nister's five points, MAGSAC).

    Args:
        camera: of the pictures' size.
        first: (h, w) uint8 grey.
        second: the later one.
    """
    before, after = tracked(first, second)
    if len(before) < LEAST_TRACKS:
        return None
    (rays, good), (later, also) = unproject(camera, before), unproject(camera, after)
    rays, later = rays[good & also], later[good & also]
    if len(rays) < LEAST_TRACKS:
        return None
    tolerance = INLIER_PX / math.sqrt(camera.fx * camera.fy)
    turn, share = _rotation_alone(rays, later, tolerance)
    travelled = _with_travel(rays, later, tolerance)
    if travelled is not None and travelled[1] > share + 0.15:
        turn, share = travelled
    return turn if share * len(rays) >= LEAST_TRACKS and share > 0.4 else None


def best_rotation(one: Floats, other: Floats) -> Floats:
    """The rotation (3, 3) that takes unit vectors (N, 3) nearest to others (Kabsch, Wahba)."""
    u, _, vt = np.linalg.svd(other.T @ one)
    return np.asarray(u @ np.diag([1.0, 1.0, np.linalg.det(u @ vt)]) @ vt)


def _rotation_alone(rays: Floats, later: Floats, tolerance: float) -> tuple[Floats, float]:
    draws = np.random.default_rng(0)
    best: tuple[int, Floats] = (0, np.eye(3))
    for _ in range(DRAWS):
        pair = draws.choice(len(rays), 2, replace=False)
        turn = best_rotation(rays[pair], later[pair])
        count = int((np.linalg.norm(rays @ turn.T - later, axis=-1) < tolerance).sum())
        if count > best[0]:
            best = count, turn
    turn = best[1]
    for _ in range(3):
        inside = np.linalg.norm(rays @ turn.T - later, axis=-1) < tolerance
        if inside.sum() < 3:
            break
        turn = best_rotation(rays[inside], later[inside])
    return turn, float((np.linalg.norm(rays @ turn.T - later, axis=-1) < tolerance).mean())


def _with_travel(rays: Floats, later: Floats, tolerance: float) -> tuple[Floats, float] | None:
    import cv2

    front = (rays[:, 2] > 0.2) & (later[:, 2] > 0.2)
    if front.sum() < LEAST_TRACKS:
        return None
    one, other = (each[front, :2] / each[front, 2:] for each in (rays, later))
    essential, inside = cv2.findEssentialMat(one, other, np.eye(3), cv2.USAC_MAGSAC, 0.999, tolerance)
    if essential is None or essential.shape != (3, 3):
        return None
    _, turn, _, _ = cv2.recoverPose(essential, one, other, np.eye(3), mask=inside.copy())
    return np.asarray(turn), float(inside.mean())

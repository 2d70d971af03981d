"""Straight edges of an image as planes through the camera."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from horizon_dl.geometry.camera import Camera
from horizon_dl.geometry.rays import unproject

Floats = NDArray[np.float64]

SHORTEST = 0.06
"""Shorter segments than this part of the image's height have no direction worth a vote."""


@dataclass(frozen=True)
class LinePlanes:
    """The planes that hold the camera and a straight edge.

    Attributes:
        normal: (N, 3) unit, optical frame; of either sign.
        length_rad: (N,) angle between the rays to the segment's ends.
    """

    normal: Floats
    length_rad: Floats


def line_planes(image: NDArray[np.uint8], camera: Camera) -> LinePlanes:
    """Line segments by OpenCV's LSD (von Gioi et al., IPOL 2012), their ends as rays, distortion undone.

    Args:
        image: (H, W, 3) uint8 RGB of the camera.
        camera: of that image size. A lens that bends lines gives pieces, each with its own plane.
    """
    import cv2

    detector = cv2.createLineSegmentDetector(cv2.LSD_REFINE_STD)
    found = detector.detect(cv2.cvtColor(image, cv2.COLOR_RGB2GRAY))[0]
    ends = np.zeros((0, 4)) if found is None else np.asarray(found, np.float64).reshape(-1, 4)
    ends = ends[np.hypot(*(ends[:, :2] - ends[:, 2:]).T) > SHORTEST * image.shape[0]]
    return planes_of(ends, camera)


def planes_of(ends: Floats, camera: Camera) -> LinePlanes:
    """Planes of segments (N, 4) of pixels u, v, u, v; those with an end outside of the lens are left out.

    Example:
        >>> camera = Camera("pinhole", 64, 48, 50.0, 50.0, 31.5, 23.5)
        >>> planes_of(np.array([[31.5, 0.0, 31.5, 40.0]]), camera).normal.round(6).tolist()[0][1:]
        [0.0, 0.0]
    """
    (first, good), (second, also) = unproject(camera, ends[:, :2]), unproject(camera, ends[:, 2:])
    normal = np.cross(first, second)[good & also]
    sine = np.linalg.norm(normal, axis=1)
    apart = sine > 1e-9
    length = np.arcsin(np.clip(sine[apart], 0.0, 1.0))
    return LinePlanes(normal[apart] / sine[apart, None], length)

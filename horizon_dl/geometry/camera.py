"""A camera's intrinsics, without any mathematics of lenses."""

import math
from dataclasses import dataclass, replace


@dataclass(frozen=True)
class Camera:
    """Intrinsics of one camera; hashable, so that its rays are computed once.

    Convention: pixel centres at integers, (0, 0) top left, u right, v down; focal lengths and principal
    point in pixels. `model` is a name in `lenses.registry`; `distortion` holds that lens's parameters: () for
    `pinhole`, (k1, k2, p1, p2, k3) in OpenCV's order for `radtan`, (k1, k2, k3, k4) for `kannala_brandt`
    (OpenCV's fisheye), ... They are of no unit: a camera of another size has the same.
    """

    model: str
    width: int
    height: int
    fx: float
    fy: float
    cx: float
    cy: float
    distortion: tuple[float, ...] = ()

    def scaled(self, width: int, height: int) -> "Camera":
        """The same camera with its image resized to width x height pixels.

        Pixel centres map as `c' = (c + 0.5) * s - 0.5`.

        Example:
            >>> Camera("pinhole", 640, 480, 500.0, 500.0, 319.5, 239.5).scaled(320, 240).cx
            159.5
        """
        sx, sy = width / self.width, height / self.height
        return replace(
            self,
            width=width,
            height=height,
            fx=self.fx * sx,
            fy=self.fy * sy,
            cx=(self.cx + 0.5) * sx - 0.5,
            cy=(self.cy + 0.5) * sy - 0.5,
        )

    def reduced(self, max_pixels: int) -> "Camera":
        """The same camera with its image made smaller until it has at most `max_pixels` pixels."""
        return self.scaled(*working_size(self.width, self.height, max_pixels))


def working_size(width: int, height: int, max_pixels: int) -> tuple[int, int]:
    """Width and height of at most `max_pixels` pixels with an image's aspect; never enlarged.

    Example:
        >>> working_size(640, 480, 76800)
        (320, 240)
    """
    scale = min(1.0, math.sqrt(max_pixels / (width * height)))
    # The small addend keeps a size that is exact but for rounding.
    return max(1, int(width * scale + 1e-6)), max(1, int(height * scale + 1e-6))

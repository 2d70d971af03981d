"""What stands on the floor: an outline that the flight keeps clear of, and the parts that are seen."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Part:
    """A cuboid or an upright cylinder of a thing, in the thing's own axes.

    Attributes:
        x: metres along the thing's own x.
        y: metres along its own y.
        half_x: half length in metres, or the radius of a cylinder.
        half_y: half width in metres; of no meaning for a cylinder.
        low_m: height of its underside over the floor.
        high_m: height of its top.
        colour: name in `PALETTE`.
        surface: name in `SURFACES`; `round` is a cylinder of one colour.
    """

    x: float
    y: float
    half_x: float
    half_y: float
    low_m: float
    high_m: float
    colour: str
    surface: str = "box"


@dataclass(frozen=True)
class Solid:
    """A thing on the floor.

    Attributes:
        kind: `box`, `panel` or `pole`, which are one body; else what it is, and its `parts` are its body.
        x: metres, world x (north).
        y: metres, world y (west).
        turn_rad: rotation about the vertical; a pole has none.
        half_x: half length of the outline in metres, or the radius of a pole.
        half_y: half width of the outline in metres, or the radius of a pole.
        height_m: metres above the floor.
        colour: name in `PALETTE`.
        parts: of things that are no single box or pole.
    """

    kind: str
    x: float
    y: float
    turn_rad: float
    half_x: float
    half_y: float
    height_m: float
    colour: str
    parts: tuple[Part, ...] = ()

    @property
    def bodies(self) -> tuple[Part, ...]:
        """Its parts; those of a box, panel or pole are one."""
        surface = "round" if self.kind == "pole" else "box"
        whole = Part(0.0, 0.0, self.half_x, self.half_y, 0.0, self.height_m, self.colour, surface)
        return self.parts or (whole,)

    def place(self, part: Part) -> tuple[float, float]:
        """Where the middle of a part is in the world, metres."""
        c, s = float(np.cos(self.turn_rad)), float(np.sin(self.turn_rad))
        return self.x + c * part.x - s * part.y, self.y + s * part.x + c * part.y

    def distance(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Horizontal distance in metres of points (N, 2) to the outline; 0 inside."""
        offset = points - (self.x, self.y)
        if self.kind == "pole":
            return np.asarray(np.maximum(np.hypot(*offset.T) - self.half_x, 0))
        c, s = np.cos(self.turn_rad), np.sin(self.turn_rad)
        along = np.abs(offset @ (c, s)) - self.half_x
        across = np.abs(offset @ (-s, c)) - self.half_y
        return np.asarray(np.hypot(np.maximum(along, 0), np.maximum(across, 0)))

    @property
    def reach_m(self) -> float:
        """Radius of the circle round the outline."""
        return self.half_x if self.kind == "pole" else float(np.hypot(self.half_x, self.half_y))

    def shades(self, points: NDArray[np.float64], towards: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Whether it stands between points of the floor and the sun; cylinders count as the boxes round them.

        Args:
            points: (N, 2) on the floor, metres.
            towards: (2,) how far a ray to the sun comes along the floor while it rises by a metre.
        """
        c, s = np.cos(self.turn_rad), np.sin(self.turn_rad)
        axes = np.array(((c, -s), (s, c)))
        start, slope = (points - (self.x, self.y)) @ axes, towards @ axes
        shaded = np.zeros(len(points), bool)
        for part in self.bodies:
            low, high = np.full(len(points), part.low_m), np.full(len(points), part.high_m)
            for axis, middle, half in ((0, part.x, part.half_x), (1, part.y, part.half_y)):
                # Heights at which the ray enters and leaves the slab of this axis.
                step = slope[axis] if abs(slope[axis]) > 1e-9 else 1e-9
                one, other = ((middle + sign * half - start[:, axis]) / step for sign in (-1, 1))
                low, high = np.maximum(low, np.minimum(one, other)), np.minimum(high, np.maximum(one, other))
            shaded |= low < high
        return shaded

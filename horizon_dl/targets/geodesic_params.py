"""What paths through the image cost."""

from dataclasses import dataclass

from horizon_dl.params import setting


@dataclass(frozen=True)
class GeodesicParams:
    """Costs of the geodesic target's paths.

    All were picked on the scores of arena, corridor, hallway, KITTI and embedded, the sets that most figures
    are reported on: expect less elsewhere; see docs/RESEARCH.md.

    Attributes:
        blur: standard deviation of the blur before the gradient, in square roots of the image's area.
        chroma: weight of the colours against the lightness: shades of one surface differ more in colour than
            is useful.
        edge_power: an edge twice as steep is more than twice as costly, so that texture is cheap and contours
            are not.
        edge_limit: no edge is costlier than this many times the mean gradient.
        length_cost: cost of a step where nothing changes, in mean gradients.
        image_share: weight of the image's edges where there are learned ones beside them.
        sure_share: share of the pixels on each side of the horizon that count as surely floor, and surely sky
            or ceiling.
        angle_weight: log odds that a pixel's side is worth more, the mean angle further from the horizon.
    """

    blur: float = setting(0.0072, 0.0, 0.1)
    chroma: float = setting(0.25, 0.0, 4.0)
    edge_power: float = setting(1.5, 0.1, 5.0)
    edge_limit: float = setting(6.0, 0.1, 1000.0)
    length_cost: float = setting(0.1, 1e-3, 10.0)
    image_share: float = setting(0.5, 0.0, 1.0)
    sure_share: float = setting(0.05, 1e-3, 1.0)
    angle_weight: float = setting(0.5, 0.0, 10.0)


GEODESIC = GeodesicParams()

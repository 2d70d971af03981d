"""The horizon of the real sets against their own geometry, read off the images by hand.

Lines that are level and parallel in the world meet in a vanishing point on the horizon; the plane through the
camera and a plumb line contains the world's up. A wrong sign of roll, pitch or mount gives errors of 10 to 30
degrees here.
"""

from pathlib import Path

import numpy as np
import pytest

from horizon_dl.geometry.rays import unproject
from horizon_dl.readers.registry import open_recording

Line = tuple[tuple[float, float], tuple[float, float]]

# Set, end of the image's name, two lines by two pixels (u, v) each, tolerance in degrees. The hallway's
# attitude is about 3 degrees off in pitch throughout (its camera looks up a little against the body).
PARALLELS: list[tuple[str, str, Line, Line, float]] = [
    ("hallway", "000000", ((370, 268), (461, 276)), ((364, 326), (516, 464)), 5.0),  # board, skirting
    ("hallway", "000012", ((245, 331), (198, 376)), ((407, 341), (536, 479)), 3.0),  # both skirtings
    ("hallway", "000026", ((196, 372), (80, 478)), ((467, 397), (556, 478)), 3.0),
    ("hallway", "000040", ((236, 338), (272, 306)), ((396, 329), (366, 305)), 5.0),  # alcove
    ("corridor", "0000000081", ((270, 262), (123, 437)), ((395, 257), (467, 342)), 1.0),  # both skirtings
    (
        "arena",
        "25815986",
        ((90, 21), (238, 34)),
        ((2, 223), (240, 155)),
        3.0,
    ),  # truss overhead, carpet's edge
    ("arena", "18816048", ((240, 5), (300, 19)), ((40, 150), (260, 124)), 3.0),
    ("arena", "44649197", ((240, 178), (500, 206)), ((267, 203), (500, 229)), 3.0),  # both edges of a strip
    # Lane markings; the road itself tilts by 1.5 degrees.
    ("kitti", "0000000000", ((553, 237), (475, 318)), ((712, 250), (798, 313)), 2.5),
    ("arena", "56182413", ((222, 154), (470, 187)), ((217, 168), (460, 204)), 3.0),
]
PLUMB: list[tuple[str, str, Line, float]] = [
    ("arena", "56182413", ((206, 20), (208, 150)), 2.0),  # truss
    ("arena", "25815986", ((250, 40), (250, 140)), 2.0),
    ("arena", "44649197", ((274, 10), (275, 175)), 2.0),  # edge of the curtain
    ("hallway", "000026", ((199, 90), (196, 370)), 2.0),  # edge of a wall
    ("kitti", "0000000000", ((439, 2), (443, 148)), 1.2),  # lamp post; the car rolls by 1.6 degrees
    ("corridor", "0000000081", ((293, 130), (293, 245)), 2.0),  # joint in the end wall
]


def plane_normal(data_dir: Path, name: str, stem: str, line: Line) -> tuple[np.ndarray, np.ndarray]:
    """Unit normal of the plane through the camera and a line of the image, and up, in the optical frame."""
    recording = open_recording(data_dir / name)
    entry = next(e for e in recording.headers if Path(e.name).stem.endswith(stem))
    assert entry.up_cam is not None
    rays, valid = unproject(recording.camera, line)
    assert valid.all()
    normal = np.cross(*rays)
    return normal / np.linalg.norm(normal), entry.up_cam


@pytest.mark.real_data
@pytest.mark.parametrize(("name", "stem", "first", "second", "tolerance_deg"), PARALLELS)
def test_horizon_passes_through_the_vanishing_point(
    data_dir: Path, name: str, stem: str, first: Line, second: Line, tolerance_deg: float
) -> None:
    (a, up), (b, _) = (plane_normal(data_dir, name, stem, line) for line in (first, second))
    point = np.cross(a, b)
    angle = np.degrees(np.arcsin(point @ up / np.linalg.norm(point)))
    assert abs(angle) < tolerance_deg


@pytest.mark.real_data
@pytest.mark.parametrize(("name", "stem", "line", "tolerance_deg"), PLUMB)
def test_plumb_lines_point_up(data_dir: Path, name: str, stem: str, line: Line, tolerance_deg: float) -> None:
    normal, up = plane_normal(data_dir, name, stem, line)
    assert abs(np.degrees(np.arcsin(normal @ up))) < tolerance_deg


@pytest.mark.real_data
def test_standing_drone_keeps_its_horizon(data_dir: Path) -> None:
    # The drone of the EuRoC sample stands still, its gyroscope off by 4.5 degrees a second.
    ups = np.array([entry.up_cam for entry in open_recording(data_dir / "euroc_sample").headers])
    assert np.degrees(np.arccos(np.clip(ups @ ups[0], -1, 1))).max() < 0.5

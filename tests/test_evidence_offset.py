"""A mount or an attitude that is off shows in where the net has its horizon."""

import math

import numpy as np
import pytest
from test_evidence_picture import CAMERA, ELEVATION, P_ABOVE, RAYS, place, scene
from test_evidence_stream import judged

from horizon_dl.evidence.horizon_offset import OffsetWatch, horizon_offset
from horizon_dl.evidence.judge import Judge
from horizon_dl.evidence.place import Place
from horizon_dl.evidence.reason import Reason
from horizon_dl.geometry.horizon import elevation

USUAL = (math.radians(-1.0), math.radians(2.0))


def tilted(angle_deg: float) -> np.ndarray:
    """Elevations by an attitude that has the horizon so much too low in the picture."""
    angle = math.radians(angle_deg)
    return elevation(RAYS, np.array([0.0, -math.cos(angle), math.sin(angle)]))


def likeliest_line(p_above: np.ndarray, heights: np.ndarray) -> float:
    """In degrees, line by line and pixel by pixel, of one part of a picture."""
    sums = {}
    for line in np.arange(-20.0, 20.25, 0.5):
        above = np.degrees(heights) > line
        p = np.where(above, p_above, 1 - p_above).clip(0.02, 0.98)
        sums[float(line)] = float(np.log(p).sum())
    return max(sums, key=lambda line: sums[line])


@pytest.mark.parametrize("angle_deg", [-12.0, -5.0, 0.0, 3.0, 10.0])
def test_a_tilt_is_measured(angle_deg: float) -> None:
    measured = math.degrees(horizon_offset(P_ABOVE, tilted(angle_deg)))
    assert measured == pytest.approx(angle_deg, abs=1.0)


def test_it_is_the_median_of_the_parts_likeliest_lines() -> None:
    rng = np.random.default_rng(3)
    p_above = (P_ABOVE + rng.normal(0, 0.5, P_ABOVE.shape)).clip(0, 1)
    p_above[:, 40:90] = rng.uniform(0, 1, (120, 50))
    small, heights = p_above[::2, ::2], ELEVATION[::2, ::2]
    lines = [likeliest_line(small[:, n : n + 5], heights[:, n : n + 5]) for n in range(0, 80, 5)]
    assert math.degrees(horizon_offset(p_above, ELEVATION)) == pytest.approx(float(np.median(lines)))


def test_an_obstacle_in_less_than_half_of_the_picture_moves_nothing() -> None:
    p_above = P_ABOVE.copy()
    p_above[:, :70] = 0.9
    assert horizon_offset(p_above, ELEVATION) == pytest.approx(0.0, abs=math.radians(0.5))


@pytest.mark.parametrize("sides", [20, 50, 65])
def test_parts_without_a_ray_say_nothing(sides: int) -> None:
    round_picture = tilted(5.0).copy()
    round_picture[:, :sides] = round_picture[:, 160 - sides :] = np.nan
    assert math.degrees(horizon_offset(P_ABOVE, round_picture)) == pytest.approx(5.0, abs=1.0)


@pytest.mark.parametrize("width", [8, 20, 31, 33])
def test_narrow_pictures_are_measured_as_wide_ones(width: int) -> None:
    middle = slice(80 - width // 2, 80 - width // 2 + width)
    measured = horizon_offset(P_ABOVE[:, middle], tilted(5.0)[:, middle])
    assert math.degrees(measured) == pytest.approx(5.0, abs=1.0)


def test_without_both_sides_in_view_it_is_not_known() -> None:
    assert math.isnan(horizon_offset(P_ABOVE, tilted(60.0)))
    assert math.isnan(horizon_offset(P_ABOVE, np.full_like(ELEVATION, np.nan)))


@pytest.mark.parametrize(
    ("offsets_deg", "wrong"),
    [
        ([0.0, 3.9, -2.9], False),  # usual, and two degrees more
        ([-3.1], True),
        ([4.1], True),
        ([9.0, 0.0, 0.0, 9.0, 0.0], False),  # the median counts
        ([0.0, 9.0, 9.0], True),
        ([9.0, math.nan], True),  # a horizon out of view takes nothing back
        ([math.nan], False),
    ],
)
def test_the_median_of_a_second_is_compared_with_what_is_usual(offsets_deg: list[float], wrong: bool) -> None:
    watch = OffsetWatch()
    problems = [
        watch.problem(index / 10, math.radians(offset), USUAL) for index, offset in enumerate(offsets_deg)
    ]
    assert problems[-1] is (Reason.MOUNT if wrong else None)


def test_what_is_older_than_a_second_or_from_later_is_forgotten() -> None:
    watch = OffsetWatch()
    for time_s in (0.0, 0.1, 0.2):
        assert watch.problem(time_s, math.radians(9.0), USUAL) is Reason.MOUNT
    assert watch.problem(1.25, 0.0, USUAL) is None
    assert watch.problem(0.5, math.radians(9.0), USUAL) is Reason.MOUNT  # a recording begun anew
    assert watch.problem(0.6, math.radians(9.0), None) is None  # a file of before it was kept


@pytest.mark.parametrize("angle_deg", [-4.0, 4.0])
def test_a_flight_with_a_mount_that_is_off_is_unknown(angle_deg: float) -> None:
    judge = Judge(CAMERA, place())
    for index in range(6):
        assert judged(judge, index / 10, scene(index), math.radians(angle_deg)).reasons == (Reason.MOUNT,)
    assert judged(Judge(CAMERA, place()), 0.0, scene(), math.radians(1.0)).reasons == ()


def test_a_picture_that_shows_nothing_does_not_blame_the_mount() -> None:
    judge = Judge(CAMERA, place())
    dark = judged(judge, 0.0, np.zeros((120, 160, 3), np.uint8), p_above=np.full_like(P_ABOVE, 0.1))
    assert Reason.MOUNT not in dark.reasons
    assert judged(judge, 0.1, scene()).reasons == ()


def test_a_card_of_before_is_read() -> None:
    card = {key: value for key, value in place().to_card().items() if key != "horizon_offset_rad"}
    judge = Judge(CAMERA, Place.from_card(card))
    assert judged(judge, 0.0, scene(), math.radians(4.0)).reasons == ()

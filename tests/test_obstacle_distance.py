"""OBSTACLE_DISTANCE by the rules of its receivers, the watchdog and the attitude buffer."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from horizon_dl.geometry.attitude import quaternion_from_rpy
from horizon_dl.geometry.polar import Bearings
from horizon_dl.ranging.sectors import FreeDistances, no_distances
from horizon_dl.runtime.watchdog import Watchdog
from horizon_dl.vehicle.attitude_buffer import AttitudeBuffer, ClockOffset
from horizon_dl.vehicle.obstacle_distance import ELEMENTS, UNKNOWN_CM, MessageShape, distances_cm

BEARINGS = Bearings(64, math.radians(1.25))  # 80 degrees: 16 elements of 5 degrees
SHAPE = MessageShape()
INF, NAN = math.inf, math.nan


def sectors(metres: NDArray[np.floating], bearings: Bearings = BEARINGS) -> FreeDistances:
    """inf is free, NaN unknown, negative an obstacle without metres."""
    values = np.asarray(metres, np.float32)
    outcome = np.where(np.isnan(values), 0, np.where(np.isinf(values), 1, 2)).astype(np.uint8)
    distance = np.where(values < 0, NAN, values).astype(np.float32)
    n = len(values)
    nothing = np.full(n, np.nan, np.float32)
    return FreeDistances(
        bearings.centres_rad,
        outcome,
        distance,
        nothing,
        nothing,
        nothing,
        np.ones(n, bool),
        np.ones(n, np.float32),
    )


def px4_map(cm: NDArray[np.uint16], shape: MessageShape) -> dict[int, float]:
    """PX4's Collision Prevention: metres by bin of 5 degrees; unknown bins are left out.

    It walks over its own bins and takes the one element at ceil((bin - offset) / increment).
    """
    found = {}
    for bin_ in range(72):
        away = (bin_ * 5.0 - shape.offset_deg) % 360.0
        index = math.ceil(away / shape.increment_deg - 1e-9)
        if index < len(cm) and cm[index] != UNKNOWN_CM:
            found[bin_] = cm[index] / 100
    return found


def ardupilot_boundary(cm: NDArray[np.uint16], shape: MessageShape) -> dict[float, float]:
    """ArduPilot's PRX1_TYPE 2: metres by direction; all before is forgotten, out of range is no reading."""
    total = min(int(360 / shape.increment_deg + 0.5), 72)
    return {
        (shape.offset_deg + index * shape.increment_deg) % 360: cm[index] / 100
        for index in range(total)
        if cm[index] != UNKNOWN_CM and shape.min_cm <= cm[index] <= shape.max_cm
    }


def test_every_element_is_the_nearest_obstacle_clear_or_unknown() -> None:
    metres = np.full(64, INF)
    metres[32:36] = [4.0, 2.5, 3.0, INF]  # 0 to 5 degrees: elements 0 and 1
    cm = distances_cm(sectors(metres), SHAPE)
    assert cm.shape == (ELEMENTS,)
    assert (cm[0], cm[1], cm[2], cm[71]) == (250, 300, 1001, 1001)
    assert (cm[8], cm[9], cm[63], cm[64]) == (UNKNOWN_CM, UNKNOWN_CM, UNKNOWN_CM, UNKNOWN_CM)
    assert (cm[3:8] == 1001).all()


def test_both_autopilots_see_the_obstacle_where_it_is() -> None:
    metres = np.full(64, INF)
    metres[24:28] = 3.0  # middle at -7.5 degrees, a quarter of a turn is 18 elements
    cm = distances_cm(sectors(metres), SHAPE)
    px4, ardupilot = px4_map(cm, SHAPE), ardupilot_boundary(cm, SHAPE)
    assert {bin_ for bin_, m in px4.items() if m == 3.0} == {70, 71}
    assert ardupilot == {350.0: 3.0, 355.0: 3.0}
    assert set(px4) == set(range(8)) | set(range(65, 72))


def test_an_obstacle_nearer_than_the_minimum_is_still_a_reading() -> None:
    cm = distances_cm(sectors(np.full(64, 0.05)), SHAPE)
    assert ardupilot_boundary(cm, SHAPE)[0.0] == pytest.approx(0.2)


@settings(deadline=None, max_examples=60)
@given(
    st.lists(st.sampled_from([INF, NAN, -1.0, 0.01, 0.9, 3.0, 9.999, 10.5, 700.0]), min_size=64, max_size=64)
)
def test_no_element_is_ever_better_than_what_is_known(metres: list[float]) -> None:
    cm = distances_cm(sectors(np.array(metres)), SHAPE)
    centres = np.degrees(BEARINGS.centres_rad.astype(np.float64))
    for index in range(ELEMENTS):
        direction = (index * 5.0 + 180) % 360 - 180
        inside = [m for m, c in zip(metres, centres, strict=True) if abs(c - direction) < 2.5]
        nearest = min((m for m in inside if m >= 0), default=INF)  # NaN and -1 are no distances
        if nearest <= 10.0:
            assert cm[index] == max(20, math.floor(np.float32(nearest) * 100))
        elif len(inside) == 4 and not any(math.isnan(m) or m == -1 for m in inside):
            assert cm[index] == 1001
        else:
            assert cm[index] == UNKNOWN_CM


def test_an_obstacle_that_covers_the_nearest_ground_is_said_at_the_minimum() -> None:
    """How near it is, nobody has seen: the farthest that it can be is no distance to fly by."""
    n, shape = BEARINGS.count, MessageShape()
    seen = sectors(np.full(n, 3.0))
    covered = replace(seen, contact_seen=np.zeros(n, bool))
    known = distances_cm(seen, shape) == 300
    assert known.any()
    assert (distances_cm(covered, shape)[known] == shape.min_cm).all()
    without_metres = replace(covered, distance_m=np.full(n, np.nan, np.float32))
    assert (distances_cm(without_metres, shape) == UNKNOWN_CM).all()


def test_none_is_unknown_everywhere() -> None:
    for found in (None, no_distances(BEARINGS.centres_rad)):
        cm = distances_cm(found, SHAPE)
        assert cm.dtype == np.uint16
        assert (cm == UNKNOWN_CM).all()
        assert px4_map(cm, SHAPE) == {}
        assert ardupilot_boundary(cm, SHAPE) == {}


def test_narrower_elements_start_at_the_left() -> None:
    shape = MessageShape(increment_deg=1.25)
    assert shape.offset_deg == pytest.approx(-44.375)
    metres = np.full(64, INF)
    metres[0] = 2.0  # -39.375 degrees
    cm = distances_cm(sectors(metres), shape)
    assert cm[4] == 200
    assert (cm[5:68] == 1001).all()
    assert (cm[:4] == UNKNOWN_CM).all()


@pytest.mark.parametrize(
    "wrong",
    [{"increment_deg": 0.0}, {"increment_deg": 6.0}, {"min_cm": 0}, {"max_cm": 10}, {"max_cm": 65534}],
)
def test_shapes_that_no_receiver_reads(wrong: dict[str, float]) -> None:
    with pytest.raises(ValueError, match=r"is not in|needs"):
        MessageShape(**wrong)  # type: ignore[arg-type]


class Time:
    def __init__(self) -> None:
        self.now = 100.0

    def __call__(self) -> float:
        return self.now


def good(dog: Watchdog, time: Time) -> None:
    dog.camera()
    dog.attitude()
    dog.result(time.now)


def test_watchdog_says_unknown_until_all_have_come() -> None:
    time = Time()
    dog = Watchdog(time)
    assert dog.troubles() == ("camera stale", "attitude stale")
    dog.camera()
    dog.attitude()
    assert dog.troubles() == ("results stale",)
    dog.result(time.now)
    assert dog.troubles() == ()


@pytest.mark.parametrize("stalled", ["camera", "attitude", "result"])
def test_each_stall_is_seen_after_300_ms_and_recovers(stalled: str) -> None:
    time = Time()
    dog = Watchdog(time)
    good(dog, time)
    for step in range(10):
        time.now += 0.1
        for name in {"camera", "attitude"} - {stalled}:
            getattr(dog, name)()
        if stalled != "result":
            dog.result(time.now)
        # Beyond 0.3 s; the fourth step is at 0.4 s, the third at 0.3 s but for rounding.
        if step != 2:
            assert bool(dog.troubles()) is (step > 2)
    good(dog, time)
    assert dog.troubles() == ()


def test_a_failing_model_holds_until_the_next_result() -> None:
    time = Time()
    dog = Watchdog(time)
    good(dog, time)
    dog.model_failed("RuntimeError")
    assert dog.troubles() == ("model failed: RuntimeError",)
    dog.result(time.now)
    assert dog.troubles() == ()


def test_old_pictures_do_not_pass_for_new_results() -> None:
    time = Time()
    dog = Watchdog(time)
    good(dog, time)
    time.now += 1.0
    dog.camera()
    dog.attitude()
    dog.result(time.now - 0.5)  # a slow model answered to an old picture
    assert dog.troubles() == ("results stale",)


def test_lines_are_said_on_changes_and_repeated() -> None:
    time = Time()
    dog = Watchdog(time)
    assert dog.to_say() == "Obstacles unknown: camera stale, attitude stale"
    assert dog.to_say() is None
    time.now += 5.1
    assert dog.to_say() is not None
    good(dog, time)
    assert dog.to_say() == "Obstacles: recovered"
    assert dog.to_say() is None
    fresh = Watchdog(time)
    good(fresh, time)
    assert fresh.to_say() == "Obstacles: ready"


def test_attitude_is_interpolated_at_the_images_time() -> None:
    buffer = AttitudeBuffer()
    for index in range(10):
        assert buffer.add(0.1 * index, quaternion_from_rpy(0.0, 0.02 * index, 0.0))
    q = buffer.at(0.45)
    assert q is not None
    np.testing.assert_allclose(q, quaternion_from_rpy(0.0, 0.09, 0.0), atol=1e-9)
    assert buffer.at(0.95) is None
    newest = buffer.at(0.95, max_ahead_s=0.1)
    np.testing.assert_allclose(newest, quaternion_from_rpy(0.0, 0.18, 0.0))
    assert buffer.at(-0.1) is None
    assert buffer.at(1.2, max_ahead_s=0.1) is None


@pytest.mark.parametrize("wrong", [[0, 0, 0, 0], [2, 0, 0, 0], [math.nan, 0, 0, 1], [math.inf, 0, 0, 0]])
def test_no_rotation_is_refused(wrong: list[float]) -> None:
    buffer = AttitudeBuffer()
    assert not buffer.add(0.0, wrong)
    assert buffer.at(0.0) is None


def test_attitudes_out_of_order_are_refused_and_gaps_not_bridged() -> None:
    buffer = AttitudeBuffer()
    level = quaternion_from_rpy(0, 0, 0)
    assert buffer.add(1.0, level)
    assert not buffer.add(0.9, level)
    assert buffer.add(2.0, level)
    assert buffer.at(1.5) is None
    buffer.clear()
    assert buffer.newest_s == -math.inf


def test_height_ages() -> None:
    buffer = AttitudeBuffer()
    assert buffer.height_at(0.0) is None
    for height in (math.nan, -1.0, 0.0, math.inf):
        buffer.add_height(0.0, height)
    assert buffer.height_at(0.0) is None
    buffer.add_height(0.0, 1.5)
    buffer.add_height(1.0, 2.0)
    assert buffer.height_at(0.2) == 1.5
    assert buffer.height_at(1.9) == 2.0
    assert buffer.height_at(2.1) is None


@settings(deadline=None, max_examples=40)
@given(st.lists(st.floats(0, 0.2), min_size=20, max_size=60), st.floats(-1000, 1000))
def test_the_senders_clock_is_found_from_the_fastest_message(delays: list[float], offset: float) -> None:
    clock = ClockOffset()
    for index, delay in enumerate([0.0, *delays]):
        sent = 0.1 * index
        ours = clock.to_ours(sent, sent + offset + delay)
        assert ours <= sent + offset + delay + 1e-9
        # The first message came without delay; since then the offset may have crept by 1 ms a second.
        assert 0 <= ours - (sent + offset) + 1e-9 <= 1e-3 * sent + 2e-9 + 1e-6


def test_a_sender_that_starts_again_is_learned_anew() -> None:
    clock = ClockOffset()
    assert clock.to_ours(500.0, 1000.0) == pytest.approx(1000.0)
    assert clock.to_ours(2.0, 1010.0) == pytest.approx(1010.0)

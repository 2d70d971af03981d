"""Evidence from frame to frame: frozen pictures, heights, a net that has to prove itself, and the judge."""

import math
from dataclasses import replace

import numpy as np
import pytest
from test_evidence_picture import CAMERA, ELEVATION, P_ABOVE, RAYS, UP, place, scene

from horizon_dl.evidence.judge import Judge, Judged, without, working_image
from horizon_dl.evidence.limits import LIMITS
from horizon_dl.evidence.place import Place
from horizon_dl.evidence.plausible import HeightWatch
from horizon_dl.evidence.reason import Reason
from horizon_dl.geometry.horizon import elevation
from horizon_dl.geometry.polar import bearings_for, polar_view
from horizon_dl.ranging.free_distance import free_distances_from_p
from horizon_dl.ranging.sectors import Outcome, no_distances

BEARINGS = bearings_for(RAYS, (0.0, 0.0, 1.0))


def up_of(pitch_rad: float) -> np.ndarray:
    return np.array([0.0, -math.cos(pitch_rad), math.sin(pitch_rad)])


def judged(
    judge: Judge, time_s: float, image: np.ndarray, pitch_rad: float = 0.0, p_above: np.ndarray = P_ABOVE
) -> Judged:
    up = up_of(pitch_rad)
    polar = polar_view(RAYS, up, bearings=BEARINGS)
    found = free_distances_from_p(p_above, polar, 1.0)
    return judge.judge(time_s, image, up, p_above, elevation(RAYS, up), found, polar)


def test_a_good_stream_is_believed() -> None:
    judge = Judge(CAMERA, place())
    for index in range(10):
        found = judged(judge, index / 10, scene(index))
        assert found.reasons == ()
        assert (found.found.outcome == Outcome.FREE).any()
        assert found.horizon_accuracy == 1.0
    assert judge.summary()["frames"] == {"believed": 10}
    assert judge.summary()["sectors"]["believed"] > 100


@pytest.mark.parametrize(
    ("image", "reason"),
    [
        (np.zeros((120, 160, 3), np.uint8), Reason.DARK),
        (np.full((120, 160, 3), 128, np.uint8), Reason.FLAT),
        (np.full((120, 160, 3), 255, np.uint8), Reason.BRIGHT),
        (scene() // 3, Reason.PLACE),
    ],
)
def test_a_bad_frame_is_unknown_everywhere_and_counted(image: np.ndarray, reason: Reason) -> None:
    judge = Judge(CAMERA, place())
    found = judged(judge, 0.0, image)
    assert reason in found.reasons
    assert (found.found.outcome == Outcome.UNKNOWN).all()
    assert judge.frames[str(reason)] == 1
    assert not judge.sectors


def test_a_net_that_is_wrong_about_the_horizon_is_not_believed() -> None:
    found = judged(Judge(CAMERA, place()), 0.0, scene(), p_above=np.full(P_ABOVE.shape, 0.1, np.float32))
    assert Reason.HORIZON in found.reasons
    assert (found.found.outcome == Outcome.UNKNOWN).all()


def test_without_limits_nothing_is_believed() -> None:
    found = judged(Judge(CAMERA, None), 0.0, scene())
    assert found.reasons == (Reason.NOT_CALIBRATED,)
    assert (found.found.outcome == Outcome.UNKNOWN).all()


def test_a_frozen_picture_is_found_as_soon_as_the_attitude_moves() -> None:
    judge = Judge(CAMERA, place())
    assert judged(judge, 0.0, scene()).reasons == ()
    assert judged(judge, 0.1, scene()).reasons == ()  # as often as it may be: the camera stands still
    for step in range(2, 8):
        assert Reason.FROZEN in judged(judge, 0.1 * step, scene(), math.radians(0.5) * step).reasons
    assert judged(judge, 0.8, scene(1), math.radians(3.5)).reasons == ()


def test_a_picture_that_never_changes_is_frozen_even_if_nothing_moves() -> None:
    judge = Judge(CAMERA, place())
    reasons = [judged(judge, 0.1 * step, scene()).reasons for step in range(20)]
    assert reasons[5] == ()
    assert all(Reason.FROZEN in found for found in reasons[12:])


def test_a_horizon_out_of_view_is_bridged_for_a_moment() -> None:
    judge = Judge(CAMERA, place())
    down = -1.0
    assert Reason.NO_SKY in judged(judge, 0.0, scene(9), down).reasons  # nothing was proved yet
    judge = Judge(CAMERA, place())
    assert judged(judge, 0.0, scene()).reasons == ()
    assert Reason.NO_SKY not in judged(judge, 0.5, scene(1), down).reasons
    assert Reason.NO_SKY in judged(judge, 0.5 + 2 * LIMITS.proof_s, scene(2), down).reasons


def test_an_attitude_that_jumps_is_not_believed() -> None:
    judge = Judge(CAMERA, place())
    judged(judge, 0.0, scene())
    assert Reason.ATTITUDE in judged(judge, 0.01, scene(1), 0.5).reasons


def test_lost_and_unfamiliar_sectors_are_taken_back_alone() -> None:
    image = scene()
    image[60:, :50] = 100  # lost on the left
    image[60:, 110:] = scene(3)[60:, 110:][..., ::-1] // 2 + np.array([0, 120, 0], np.uint8)
    wide = Place(
        tuple(np.array(place().low) - 99), tuple(np.array(place().high) + 99), place().colours, 8, 1.0
    )
    judge = Judge(CAMERA, wide)
    found = judged(judge, 0.0, image)
    assert found.reasons == ()
    outcome = found.found.outcome
    assert (outcome[:4] == Outcome.UNKNOWN).all()
    assert (outcome[-4:] == Outcome.UNKNOWN).all()
    assert (outcome[len(outcome) // 2 - 3 : len(outcome) // 2 + 3] == Outcome.FREE).all()
    assert set(found.sectors) == {Reason.LOST, Reason.FLOOR}
    assert judge.sectors[str(Reason.LOST)] == found.sectors[Reason.LOST] > 0


def test_smoothed_ground_as_in_training_keeps_its_sectors() -> None:
    known = place()
    wide = replace(known, low=tuple(np.array(known.low) - 99), high=tuple(np.array(known.high) + 99))
    image = scene()
    image[90:] = (104, 88, 72)
    flat = np.zeros((16, 16, 16), bool)
    flat[104 // 16, 88 // 16, 72 // 16] = True
    assert judged(Judge(CAMERA, wide), 0.0, image).sectors[Reason.LOST] > 20
    assert Reason.LOST not in judged(Judge(CAMERA, replace(wide, flat=flat)), 0.0, image).sectors


def test_known_doubts_hold_whatever_the_picture_shows() -> None:
    judge = Judge(CAMERA, place())
    polar = polar_view(RAYS, UP, bearings=BEARINGS)
    found = free_distances_from_p(P_ABOVE, polar, 1.0)
    taken = judge.judge(0.0, scene(), UP, P_ABOVE, ELEVATION, found, polar, doubts=(Reason.HEIGHT,))
    assert taken.reasons == (Reason.HEIGHT,)
    assert (taken.found.outcome == Outcome.UNKNOWN).all()


def test_without_some_sectors() -> None:
    found = free_distances_from_p(P_ABOVE, polar_view(RAYS, UP, bearings=BEARINGS), 1.0)
    unknown = np.arange(len(found.outcome)) % 2 == 0
    left = without(found, unknown)
    nothing = no_distances(found.bearing_rad)
    np.testing.assert_array_equal(left.outcome[unknown], nothing.outcome[unknown])
    np.testing.assert_array_equal(left.distance_m[~unknown], found.distance_m[~unknown])
    assert np.isnan(left.depression_rad[unknown]).all()


def test_a_larger_picture_is_judged_at_the_working_size() -> None:
    large = np.repeat(np.repeat(scene(), 2, 0), 2, 1)
    np.testing.assert_array_equal(working_image(large, (120, 160)), scene())
    assert judged(Judge(CAMERA, place()), 0.0, large).reasons == ()


@pytest.mark.parametrize("height_m", [1000.0, 2147483.0, -1e30, 0.0, math.nan, math.inf, 121.0])
def test_heights_that_cannot_be(height_m: float) -> None:
    watch = HeightWatch()
    assert watch.good(0.0, 1.0)
    for step in range(1, 40):
        assert not watch.good(0.1 * step, height_m)


def test_a_height_that_jumps_is_believed_only_when_it_stays() -> None:
    watch = HeightWatch()
    assert watch.good(0.0, 1.0)
    assert not watch.good(0.1, 40.0)
    assert watch.good(0.2, 1.1)
    jumped = [watch.good(0.3 + 0.1 * step, 40.0) for step in range(15)]
    assert jumped[:9] == [False] * 9
    assert jumped[-1]


@pytest.mark.parametrize("height_m", [4.0, 8.0, 15.0, 40.0])
def test_a_jump_is_doubted_for_a_second_however_far_one_could_have_climbed_meanwhile(height_m: float) -> None:
    watch = HeightWatch()
    assert watch.good(0.0, 1.0)
    assert [watch.good(0.1 + 0.1 * step, height_m) for step in range(10)] == [False] * 10
    assert watch.good(1.15, height_m)


def test_heights_that_leap_to_and_fro_are_never_believed() -> None:
    watch = HeightWatch()
    assert watch.good(0.0, 1.0)
    assert not any(watch.good(0.1 * step, 8.0 if step % 2 else 20.0) for step in range(1, 60))
    assert watch.good(6.1, 1.1)


def test_a_climb_and_a_table_are_no_jumps() -> None:
    watch = HeightWatch()
    assert all(watch.good(0.1 * step, 1.0 + 0.5 * step) for step in range(100))
    watch = HeightWatch()
    assert all(watch.good(0.1 * step, 1.2 if step % 7 else 0.75) for step in range(50))


def test_after_a_silence_any_possible_height_is_believed() -> None:
    watch = HeightWatch()
    assert watch.good(0.0, 1.0)
    assert watch.good(10.0, 60.0)


def test_limits_are_values() -> None:
    strict = replace(LIMITS, strangeness=-1.0)
    found = judged(Judge(CAMERA, place(), strict), 0.0, scene())
    assert Reason.PLACE in found.reasons

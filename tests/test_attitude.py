"""Attitude: against scipy, and cases worked out by hand."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation, Slerp

from horizon_dl.geometry.attitude import (
    bracket,
    interpolate,
    quaternion_from_rpy,
    rotation_from_quaternion,
    rotation_from_rpy,
    rpy_from_rotation,
    slerp,
    unit,
    up_in_camera,
)

LEVEL = (0.0, 0.0, 0.0)
ANGLE = st.floats(-3.1, 3.1)
PITCH = st.floats(-1.5, 1.5)


def scipy_quaternion(rotation: Rotation) -> np.ndarray:
    return np.roll(rotation.as_quat(), 1)


@given(ANGLE, PITCH, ANGLE)
def test_quaternion_agrees_with_scipy(roll: float, pitch: float, yaw: float) -> None:
    reference = Rotation.from_euler("ZYX", [yaw, pitch, roll])
    q = quaternion_from_rpy(roll, pitch, yaw)
    assert abs(q @ scipy_quaternion(reference)) == pytest.approx(1.0, abs=1e-12)
    np.testing.assert_allclose(rotation_from_quaternion(q), reference.as_matrix(), atol=1e-12)
    assert rpy_from_rotation(reference.as_matrix()) == pytest.approx((roll, pitch, yaw), abs=1e-9)


@given(ANGLE, PITCH, ANGLE, PITCH, st.floats(0, 1))
def test_slerp_agrees_with_scipy(roll: float, pitch: float, yaw: float, pitch_2: float, part: float) -> None:
    ends = Rotation.from_euler("ZYX", [[yaw, pitch, roll], [yaw + 0.5, pitch_2, roll - 0.3]])
    ours = slerp(scipy_quaternion(ends[0]), -scipy_quaternion(ends[1]), part)
    theirs = scipy_quaternion(Slerp([0, 1], ends)([part])[0])
    assert abs(ours @ theirs) == pytest.approx(1.0, abs=1e-6)


@given(ANGLE, PITCH, ANGLE, PITCH)
def test_up_is_a_unit_vector_and_blind_to_the_heading(
    roll: float, pitch: float, yaw: float, m: float
) -> None:
    up = up_in_camera(quaternion_from_rpy(roll, pitch, yaw), (0.0, m, 0.0))
    assert np.linalg.norm(up) == pytest.approx(1.0)
    np.testing.assert_allclose(
        up, up_in_camera(quaternion_from_rpy(roll, pitch, 0.0), (0.0, m, 0.0)), atol=1e-12
    )


def test_level_camera_has_up_against_v() -> None:
    np.testing.assert_allclose(up_in_camera([1, 0, 0, 0], LEVEL), [0, -1, 0], atol=1e-15)


def test_nose_up_leans_up_along_the_optical_axis() -> None:
    # The optical axis then has a part along up, so the two have a positive product.
    up = up_in_camera(quaternion_from_rpy(0.0, 0.3, 0.0), LEVEL)
    np.testing.assert_allclose(up, [0.0, -math.cos(0.3), math.sin(0.3)], atol=1e-12)


def test_right_side_down_leans_up_to_the_left() -> None:
    up = up_in_camera(quaternion_from_rpy(0.2, 0.0, 0.0), LEVEL)
    np.testing.assert_allclose(up, [-math.sin(0.2), -math.cos(0.2), 0.0], atol=1e-12)


def test_mount_looking_down_equals_nose_down() -> None:
    down = math.radians(-16.7)
    mounted = up_in_camera([1, 0, 0, 0], (0.0, down, 0.0))
    np.testing.assert_allclose(mounted, up_in_camera(quaternion_from_rpy(0, down, 0), LEVEL), atol=1e-12)
    assert mounted[2] == pytest.approx(-math.sin(math.radians(16.7)))


def test_mount_is_applied_in_the_body() -> None:
    # A camera that looks to the right (yaw 90 degrees in the body) sees the body's roll as its own pitch.
    up = up_in_camera(quaternion_from_rpy(0.2, 0.0, 0.0), (0.0, 0.0, math.pi / 2))
    np.testing.assert_allclose(up, [0.0, -math.cos(0.2), -math.sin(0.2)], atol=1e-12)


def test_interpolate_takes_the_shorter_arc_and_respects_gaps() -> None:
    times = np.array([0.0, 1.0, 5.0])
    a, b = quaternion_from_rpy(0.0, 0.0, 0.1), quaternion_from_rpy(0.0, 0.0, 0.3)
    samples = np.stack([a, -b, b])
    middle = interpolate(times, samples, 0.5, 1.0)
    assert middle is not None
    assert abs(middle @ quaternion_from_rpy(0.0, 0.0, 0.2)) == pytest.approx(1.0)
    assert interpolate(times, samples, 3.0, 1.0) is None
    assert interpolate(times, samples, -0.1, 1.0) is None
    assert interpolate(times, samples, 5.1, 1.0) is None
    last = interpolate(times, samples, 5.0, 1.0)
    assert last is not None
    assert abs(last @ b) == pytest.approx(1.0)


def test_bracket_of_none_one_and_equal_times() -> None:
    assert bracket(np.array([]), 0.0, 1.0) is None
    assert bracket(np.array([2.0]), 2.0, 1.0) == (0, 0.0)
    assert bracket(np.array([1.0, 1.0, 2.0]), 1.5, 1.0) == (1, 0.5)
    assert bracket(np.array([0.0, 9.0]), 9.0, 1.0) == (0, 1.0)


@pytest.mark.parametrize("bad", [[0, 0, 0, 0], [math.nan, 0, 0, 1], [math.inf, 0, 0, 0]])
def test_what_is_no_rotation_is_refused(bad: list[float]) -> None:
    with pytest.raises(ValueError, match="not a rotation"):
        rotation_from_quaternion(bad)
    with pytest.raises(ValueError, match="no direction"):
        unit(bad)


def test_rotation_from_rpy_by_hand() -> None:
    # Yaw by 90 degrees: the body's forward axis points east.
    np.testing.assert_allclose(rotation_from_rpy(0, 0, math.pi / 2) @ [1, 0, 0], [0, 1, 0], atol=1e-12)

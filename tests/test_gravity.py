"""The IMU's estimate of up, on synthetic motion whose truth is known from scipy."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from horizon_dl.data.imu import estimate_up, still_bias

RATE_HZ = 200
GRAVITY = np.array([0.0, 0.0, 9.81])


def flight(seconds: float, bias: np.ndarray, still_s: float, noise: float) -> tuple[np.ndarray, ...]:
    """Times, rates, accelerations and true up in the body for a swaying, yawing flight (world z up)."""
    times = np.arange(0, seconds, 1 / RATE_HZ)
    moving = np.clip((times - still_s) / 2, 0, 1) * (times > still_s)
    angles = np.stack(
        [
            0.3 * times * moving,
            0.2 * np.sin(1.3 * times) * moving,
            0.25 * np.sin(0.9 * times + 1) * moving,
        ],
        axis=-1,
    )
    attitude = Rotation.from_euler("ZYX", angles)  # body to world
    turns = (attitude[:-1].inv() * attitude[1:]).as_rotvec() * RATE_HZ
    rates = np.vstack([turns, turns[-1:]])
    sway = np.stack([np.sin(2 * times), np.cos(1.7 * times), 0.5 * np.sin(3 * times)], -1) * moving[:, None]
    rng = np.random.default_rng(0)
    rates = rates + bias + rng.normal(0, noise / 50, rates.shape)
    forces = attitude.inv().apply(GRAVITY + sway) + rng.normal(0, noise, rates.shape)
    return times, rates, forces, attitude.inv().apply([0.0, 0.0, 1.0])


def error_deg(estimate: np.ndarray, truth: np.ndarray) -> np.ndarray:
    return np.degrees(np.arccos(np.clip((estimate * truth).sum(axis=-1), -1, 1)))


def test_at_rest_up_is_where_the_accelerometer_points() -> None:
    times = np.arange(0, 5, 0.005)
    direction = np.array([0.926, 0.012, -0.377])
    direction /= np.linalg.norm(direction)
    forces = np.tile(9.81 * direction, (len(times), 1))
    estimate = estimate_up(times, np.zeros((len(times), 3)), forces)
    np.testing.assert_allclose(estimate, np.tile(direction, (len(times), 1)), atol=1e-9)


@pytest.mark.parametrize("still_s", [2.0, 0.0], ids=["still first", "moving from the start"])
def test_flight_with_bias_and_vibration(still_s: float) -> None:
    times, rates, forces, truth = flight(60.0, np.array([-0.002, 0.02, 0.078]), still_s, noise=0.8)
    errors = error_deg(estimate_up(times, rates, forces), truth)
    assert np.sqrt(np.mean(errors**2)) < 3.0
    assert np.median(errors) < 2.0
    # The accelerometer alone is far worse, so the gyroscope does its part.
    alone = error_deg(forces / np.linalg.norm(forces, axis=-1, keepdims=True), truth)
    assert np.median(alone) > 1.5 * np.median(errors)


def test_fast_turn_is_followed_by_the_gyroscope() -> None:
    # 90 degrees about x within 0.5 s, with an accelerometer that is ignored meanwhile (30 m/s^2).
    times = np.arange(0, 2.5, 0.005)
    turning = (times >= 1.0) & (times < 1.5)
    rates = np.zeros((len(times), 3))
    rates[turning, 0] = np.pi
    forces = np.tile(GRAVITY, (len(times), 1))
    forces[times >= 1.0] = [30.0, 0.0, 0.0]
    estimate = estimate_up(times, rates, forces)
    np.testing.assert_allclose(estimate[-1], [0.0, 1.0, 0.0], atol=1e-2)


def test_bias_of_an_imu_that_stands_still_is_its_mean_rate() -> None:
    rng = np.random.default_rng(1)
    times = np.arange(0, 3, 0.005)
    rates = np.array([0.01, 0.02, 0.08]) + rng.normal(0, 0.02, (len(times), 3))
    forces = GRAVITY + rng.normal(0, 0.3, (len(times), 3))
    bias = still_bias(times, rates, forces)
    assert bias == pytest.approx((0.01, 0.02, 0.08), abs=0.006)


def test_no_bias_is_taken_from_an_imu_that_moves_or_from_too_few_samples() -> None:
    times = np.arange(0, 3, 0.005)
    forces = np.tile(GRAVITY, (len(times), 1))
    rates = np.stack([0.3 * np.sin(3 * times)] * 3, axis=-1)
    assert still_bias(times, rates, forces) is None
    assert still_bias(times[:5], rates[:5] * 0, forces[:5]) is None


def test_result_is_made_of_unit_vectors() -> None:
    times, rates, forces, _ = flight(10.0, np.zeros(3), 0.0, noise=1.0)
    assert np.linalg.norm(estimate_up(times, rates, forces), axis=-1) == pytest.approx(1.0)

"""The limits of all evidence in one place, with the data on which they were chosen."""

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class EvidenceLimits:
    """What a frame and a sector must show.

    Chosen on the embedded set and the corridor (nets trained without the fourth and the eighth tenth of the
    frames); `horizon_margin` on the arena's frames that were left out, too. Hallway and KITTI only scored:
    see `docs/SAFETY.md`.

    Attributes:
        dark_level: grey levels of 255; a pixel darker than this shows nothing.
        bright_level: a pixel brighter than this shows nothing.
        most_unusable: share of such pixels from which on a picture is black or overexposed.
        least_contrast: standard deviation of the sketch, grey levels.
        lost_channel_sd: a colour channel that varies less than this while another varies ten times as much
            is lost; grey levels.
        frozen_turn_rad: a picture that stays although the camera turned by this much is frozen.
        compared_turn_rad: a smaller turn is hardly seen in a sketch.
        memory_s: for so long a picture is compared with an earlier one.
        band_rad: around the horizon, where no side is asked for.
        least_sky: share of the pixels on each side of the horizon that a horizon needs to be judged by.
        least_horizon_accuracy: balanced accuracy of the known side; one that says the same everywhere has
            0.5, whatever it says.
        least_trained_accuracy: mean of that over the training pictures, under which no net is flown.
        horizon_margin: below the worst training frame by this much is worse than a net may be.
        proof_s: a horizon out of view is bridged for so long by what was proved before.
        strangeness: how far a picture may lie outside of the training pictures, in their own ranges.
        lost_share: share of a sector's claimed floor without any change from pixel to pixel.
        strange_share: share of a sector's claimed floor of colours that the training never saw below the
            horizon.
        height_m: least and most height over the floor that a flight by sight can have.
        still_s: a live picture never stays the same for so long: a sensor has noise.
        attitude_still_s: nor does a live attitude: an IMU has noise, too.
        climb_m_s: faster no height changes.
        turn_rad_s: faster no attitude changes.
    """

    dark_level: int = 8
    bright_level: int = 247
    most_unusable: float = 0.9
    least_contrast: float = 1.5
    lost_channel_sd: float = 1.0
    frozen_turn_rad: float = math.radians(0.3)
    compared_turn_rad: float = math.radians(4.0)
    memory_s: float = 0.5
    band_rad: float = math.radians(3.0)
    least_sky: float = 0.02
    least_horizon_accuracy: float = 0.65
    least_trained_accuracy: float = 0.75
    horizon_margin: float = 0.05
    proof_s: float = 2.0
    strangeness: float = 0.35
    lost_share: float = 0.1
    strange_share: float = 0.3
    height_m: tuple[float, float] = (0.03, 120.0)
    still_s: float = 1.0
    attitude_still_s: float = 2.0
    climb_m_s: float = 20.0
    turn_rad_s: float = 15.0


LIMITS = EvidenceLimits()

"""The limits of all evidence in one place, with the data on which they were chosen."""

from dataclasses import dataclass

from horizon_dl.params import angle_deg, setting


@dataclass(frozen=True)
class EvidenceLimits:
    """What a frame and a sector must show.

    Chosen on the embedded set and the corridor (nets trained without the fourth and the eighth tenth of the
    frames); `horizon_margin` on the arena's frames that were left out, too. Hallway and KITTI only scored:
    see `docs/SAFETY.md`. `offset_margin_rad` (one of 1 to 4 degrees) was chosen on the same two; arena,
    hallway and KITTI scored it.

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
        offset_margin_rad: so far outside of what was usual in training the net's horizon may lie.
        offset_s: over so long the median of that is taken.
        proof_s: a horizon out of view is bridged for so long by what was proved before.
        strangeness: how far a picture may lie outside of the training pictures, in their own ranges.
        lost_share: share of a sector's claimed floor without any change from pixel to pixel.
        strange_share: share of a sector's claimed floor of colours that the training never saw below the
            horizon.
        least_height_m: height over the floor that a flight by sight has at least.
        most_height_m: and at most.
        still_s: a live picture never stays the same for so long: a sensor has noise.
        attitude_still_s: nor does a live attitude: an IMU has noise, too.
        climb_m_s: faster no height changes.
        turn_rad_s: faster no attitude changes.
    """

    dark_level: int = setting(8, 0, 255)
    bright_level: int = setting(247, 0, 255)
    most_unusable: float = setting(0.9, 0.0, 1.0)
    least_contrast: float = setting(1.5, 0.0, 50.0)
    lost_channel_sd: float = setting(1.0, 0.0, 50.0)
    frozen_turn_rad: float = angle_deg(0.3, 0.01, 30.0)
    compared_turn_rad: float = angle_deg(4.0, 0.1, 90.0)
    memory_s: float = setting(0.5, 0.0, 10.0)
    band_rad: float = angle_deg(3.0, 0.0, 30.0)
    least_sky: float = setting(0.02, 0.0, 0.5)
    least_horizon_accuracy: float = setting(0.65, 0.5, 1.0)
    least_trained_accuracy: float = setting(0.75, 0.5, 1.0)
    horizon_margin: float = setting(0.05, 0.0, 0.5)
    offset_margin_rad: float = angle_deg(2.0, 0.1, 20.0)
    offset_s: float = setting(1.0, 0.0, 10.0)
    proof_s: float = setting(2.0, 0.0, 60.0)
    strangeness: float = setting(0.35, 0.0, 100.0)
    lost_share: float = setting(0.1, 0.0, 1.0)
    strange_share: float = setting(0.3, 0.0, 1.0)
    least_height_m: float = setting(0.03, 0.001, 10.0)
    most_height_m: float = setting(120.0, 0.1, 10000.0)
    still_s: float = setting(1.0, 0.05, 60.0)
    attitude_still_s: float = setting(2.0, 0.05, 60.0)
    climb_m_s: float = setting(20.0, 0.1, 300.0)
    turn_rad_s: float = setting(15.0, 0.1, 100.0)

    @property
    def height_m(self) -> tuple[float, float]:
        """Least and most height."""
        return self.least_height_m, self.most_height_m


LIMITS = EvidenceLimits()

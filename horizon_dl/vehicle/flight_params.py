"""When the flight loop stops believing, and what it joins."""

from dataclasses import dataclass

from horizon_dl.params import setting


@dataclass(frozen=True)
class FlightParams:
    """Of the watchdog and the temporal filter. None was picked on data.

    Attributes:
        stale_s: oldest picture, attitude or result that still counts; an older one makes all unknown.
        repeat_s: how often a trouble that lasts is said again to the pilot.
        doubt_s: a doubt is said for so long after its last frame: what flickers is not said anew.
        doubt_share: with more than this share of the sectors without evidence the pilot is told.
        filter_frames: frames that the median of a sector joins; odd.
        filter_age_s: frames older than this are forgotten.
        filter_gap_s: after a longer gap between two frames, those before it say nothing any more.
    """

    stale_s: float = setting(0.3, 0.05, 2.0)
    repeat_s: float = setting(5.0, 0.5, 600.0)
    doubt_s: float = setting(2.0, 0.0, 60.0)
    doubt_share: float = setting(0.1, 0.0, 1.0)
    filter_frames: int = setting(3, 1, 31)
    filter_age_s: float = setting(0.5, 0.0, 10.0)
    filter_gap_s: float = setting(0.3, 0.0, 10.0)

    def __post_init__(self) -> None:
        if self.filter_frames % 2 == 0:
            raise ValueError(f"filter_frames = {self.filter_frames} is even: a median needs an odd number")

"""Why a frame, or a sector of it, is not believed."""

from enum import StrEnum


class Reason(StrEnum):
    """Short enough to stand behind "Obstacles unknown: " in a STATUSTEXT of 50 characters."""

    DARK = "black"
    BRIGHT = "overexposed"
    FLAT = "no contrast"
    CHANNEL = "a colour is lost"
    TORN = "picture torn"
    FROZEN = "image frozen"
    HORIZON = "net is wrong about horizon"
    MOUNT = "attitude or mount is off"
    PLACE = "unfamiliar picture"
    NOT_CALIBRATED = "model not calibrated"
    HEIGHT = "height cannot be"
    ATTITUDE = "attitude jumped"
    ATTITUDE_STILL = "attitude frozen"
    LOST = "part of the picture lost"
    FLOOR = "unfamiliar floor"
    NO_SKY = "horizon out of view"

"""Frames by their names: worlds, and the robot's own body (REP 105), within whatever namespace."""

BODIES = ("base_link", "base_footprint", "base", "body", "fcu")
WORLDS = ("map", "odom", "world", "earth", "mocap", "vicon", "optitrack", "global", "local_origin")


def is_body(name: str) -> bool:
    """Whether it is the robot's own frame.

    Example:
        >>> is_body("base_link"), is_body("drone_0/base_link"), is_body("camera_link")
        (True, True, False)
    """
    return _last(name) in BODIES


def is_world(name: str) -> bool:
    """Whether it is a world, in which things are turned, and no thing itself.

    Example:
        >>> is_world("map"), is_world("robot1/odom"), is_world("base_link"), is_world("")
        (True, True, False, False)
    """
    return _last(name).startswith(WORLDS)


def points_down(name: str) -> bool:
    """Whether a world's z points down, as its name says (AirSim, NED frames of mavros).

    Example:
        >>> points_down("world_ned"), points_down("map_ned"), points_down("map")
        (True, True, False)
    """
    return is_world(name) and "ned" in _last(name).split("_")


def _last(name: str) -> str:
    return name.rsplit("/", 1)[-1].lower()

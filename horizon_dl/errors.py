"""The one exception that stands for wrong input."""

from pathlib import Path


class InputError(Exception):
    """Input that the user has to mend: one line with the file, the problem and the way out (exit code 2).

    Example:
        >>> str(InputError("camera.yaml", "has no field 'fx'", "add the focal length in pixels"))
        "camera.yaml: has no field 'fx'; add the focal length in pixels"
    """

    def __init__(self, where: str | Path, problem: str, way_out: str) -> None:
        super().__init__(where, problem, way_out)  # all of it, so that it can travel between processes

    def __str__(self) -> str:
        return "{}: {}; {}".format(*self.args)


class FrameError(InputError):
    """One frame that cannot be read; sets go on without it and count it."""

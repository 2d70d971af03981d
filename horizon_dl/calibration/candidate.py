"""The cameras that a file offers, and which of them is meant."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from horizon_dl.errors import InputError
from horizon_dl.geometry.camera import Camera

Size = tuple[int, int]


@dataclass(frozen=True)
class Found:
    """What a file says of one camera.

    Attributes:
        camera: intrinsics.
        imu_from_camera: rotation (3, 3) from the optical frame to the axes of the IMU or body, if stated.
        imu_field: the field that states it, for messages.
        notes: what was done that the user should know, a sentence each.
    """

    camera: Camera
    imu_from_camera: NDArray[np.float64] | None = None
    imu_field: str = ""
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class Wanted:
    """What is known of the camera that is meant.

    Attributes:
        size: width and height of its images, pixels; for files without a size it is taken.
        name: its name or topic.
    """

    size: Size | None = None
    name: str | None = None


@dataclass(frozen=True)
class Candidate:
    """One camera of a file, not looked into yet: its neighbour's lens may not be known.

    Attributes:
        names: under which it can be asked for; the first is shown.
        size: of its images, if stated.
        build: looks into it.
    """

    names: tuple[str, ...]
    size: Size | None
    build: Callable[[], Found]


def choose(path: Path, candidates: Sequence[Candidate], wanted: Wanted) -> tuple[Found, tuple[str, ...]]:
    """The camera that is meant, and a note of how it was chosen where there was a choice.

    Raises:
        InputError: none fits, or several.
    """
    if not candidates:
        raise InputError(path, "describes no camera", "give the file that the calibration wrote")
    if len(candidates) == 1 and wanted.name is None:
        return candidates[0].build(), ()
    left, how = list(candidates), ""
    if wanted.name is not None:
        name = wanted.name.strip("/")
        left = [one for one in left if name in [each.strip("/") for each in one.names]]
        how = "by its name"
        if not left:
            problem = f"has no camera '{wanted.name[:40]}', but {_listed(candidates)}"
            raise InputError(path, problem, "name one of these")
    if len(left) > 1 and wanted.size is not None:
        fitting = [one for one in left if one.size in (None, wanted.size)]
        turned = [one for one in left if one.size == wanted.size[::-1]]
        left, how = fitting or turned, "by the images' size"
        if not left:
            size = f"{wanted.size[0]}x{wanted.size[1]}"
            raise InputError(
                path, f"has no camera for images of {size}, but {_listed(candidates)}", "give their own file"
            )
    if len(left) > 1:
        raise InputError(
            path,
            f"has {len(left)} cameras that fit: {_listed(left)}",
            f"say which took the images with a line like 'use_camera: {left[0].names[0]}' in it",
        )
    found = left[0].build()
    return found, (f"camera {_labelled(left[0])} of {path.name}, chosen {how}",) if how else ()


def _listed(candidates: Sequence[Candidate]) -> str:
    listed = [_labelled(one) for one in candidates[:8]]
    return listed[0] if len(listed) == 1 else f"{', '.join(listed[:-1])} and {listed[-1]}"


def _labelled(one: Candidate) -> str:
    more = [name[:60] for name in one.names[1:2]]
    more += [f"{one.size[0]}x{one.size[1]}"] if one.size else []
    return f"{one.names[0][:40]} ({', '.join(more)})" if more else one.names[0][:40]

"""How the numbers of an attitude are to be read: their order and unit, the body's axes, the world's up.

A reader keeps the numbers as they stand in the file beside what it made of them, so that they can be read
otherwise: by the user's word, or to find out which way of reading agrees with the pictures.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from horizon_dl.errors import InputError
from horizon_dl.geometry.attitude import OPTICAL_FROM_FRD, rotation_from_rpy
from horizon_dl.geometry.axes import axes_in_words, frd_from_axes

Floats = NDArray[np.float64]
UP_WORDS = {"x": "x-up", "-x": "x-down", "y": "y-up", "-y": "y-down", "z": "z-up", "-z": "z-down"}


@dataclass(frozen=True)
class Convention:
    """One way to read an attitude.

    Attributes:
        body: where x, y and z of the body point, as `frd`; see `geometry.axes`.
        up: the world's axis that points up, as `-z` (NED) or `z` (ENU).
        order: of a quaternion's numbers; of no matter to angles.
        unit: of angles; of no matter to quaternions.
        inverse: the rotation leads from the world to the body.
    """

    body: str = "frd"
    up: str = "-z"
    order: Literal["wxyz", "xyzw"] = "wxyz"
    unit: Literal["rad", "deg"] = "rad"
    inverse: bool = False

    def ups_in_body(self, numbers: Floats) -> Floats:
        """The world's up (N, 3) in the body's own axes; NaN where the numbers are.

        Args:
            numbers: (N, 3) roll, pitch, yaw, or (N, 4) quaternions, as they stand in the file.
        """
        return self.ups_of(self.rotations(numbers))

    def ups_of(self, rotations: Floats) -> Floats:
        """As `ups_in_body`, of rotations (N, 3, 3) that `rotations` made of the numbers."""
        axis = "xyz".index(self.up[-1])
        ups = rotations[:, :, axis] if self.inverse else rotations[:, axis, :]
        return -ups if self.up[0] == "-" else ups

    def ups_in_camera(self, numbers: Floats, camera_from_frd: Floats) -> Floats:
        """The world's up (N, 3) in the optical frame.

        Args:
            numbers: see `ups_in_body`.
            camera_from_frd: rotation (3, 3) from the body (FRD) to the optical frame: the mount.
        """
        turn = camera_from_frd @ frd_from_axes(self.body, left_handed=True)
        return self.ups_in_body(numbers) @ turn.T

    def differences(self, other: "Convention", quaternions: bool) -> list[str]:
        """This convention in words of the option `--convention`, as far as it differs from another."""
        words: list[str] = [self.order] if quaternions and self.order != other.order else []
        words += [self.unit] if not quaternions and self.unit != other.unit else []
        words += [self.body] if self.body != other.body else []
        words += [UP_WORDS[self.up]] if self.up != other.up else []
        return words + ["inverse"] * (self.inverse and not other.inverse)

    def rotations(self, numbers: Floats) -> Floats:
        """(N, 3, 3) from the body to the world, `inverse` left aside."""
        numbers = np.asarray(numbers, np.float64)
        if numbers.shape[1] == 3:
            angles = np.radians(numbers) if self.unit == "deg" else numbers
            return np.array([_of_angles(row) for row in np.nan_to_num(angles)]) + 0.0 * numbers[:, :1, None]
        w, x, y, z = (numbers if self.order == "wxyz" else numbers[:, [3, 0, 1, 2]]).T
        with np.errstate(invalid="ignore", divide="ignore"):
            s = 2.0 / (w * w + x * x + y * y + z * z)
        rows = [
            [1 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y)],
            [s * (x * y + w * z), 1 - s * (x * x + z * z), s * (y * z - w * x)],
            [s * (x * z - w * y), s * (y * z + w * x), 1 - s * (x * x + y * y)],
        ]
        return np.moveaxis(np.array(rows), -1, 0)


@dataclass(frozen=True)
class Reading:
    """How a recording's attitudes were read.

    Attributes:
        convention: of the numbers.
        camera_from_frd: rotation from the body (FRD) to the optical frame, its nine numbers in rows.
    """

    convention: Convention
    camera_from_frd: tuple[float, ...]

    @property
    def mount(self) -> Floats:
        """`camera_from_frd` (3, 3)."""
        return np.array(self.camera_from_frd).reshape(3, 3)


def reading_with(convention: Convention, mount_rpy_rad: Sequence[float]) -> Reading:
    """A reading for a camera that is mounted with roll, pitch and yaw, rad."""
    matrix = OPTICAL_FROM_FRD @ rotation_from_rpy(*mount_rpy_rad).T
    return Reading(convention, tuple(matrix.ravel().tolist()))


def parse_convention(words: str, stated: Convention) -> Convention:
    """The convention of the option `--convention`: words as `xyzw`, `flu`, `z-up`, `deg`, `inverse`.

    Raises:
        InputError: a word that is not known.
    """
    for word in words.lower().replace(",", " ").split():
        up = next((axis for axis, name in UP_WORDS.items() if name == word), None)
        if up is not None:
            stated = replace(stated, up=up)
        elif word in ("wxyz", "xyzw"):
            stated = replace(stated, order=word)  # type: ignore[arg-type]
        elif word in ("rad", "deg"):
            stated = replace(stated, unit=word)  # type: ignore[arg-type]
        elif word == "inverse":
            stated = replace(stated, inverse=True)
        else:
            stated = replace(stated, body=_axes(word))
    return stated


def convention_in_words(convention: Convention, stated: Convention, quaternions: bool) -> str:
    """How a convention differs from the one that was stated, for people."""
    says = []
    if quaternions and convention.order != stated.order:
        says.append(f"the quaternion is {' '.join(convention.order)}")
    if not quaternions and convention.unit != stated.unit:
        says.append(f"the angles are {'degrees' if convention.unit == 'deg' else 'radians'}")
    if convention.body != stated.body:
        says.append(f"the body's axes are {convention.body.upper()} ({axes_in_words(convention.body)})")
    if convention.up != stated.up:
        says.append(f"the world's {UP_WORDS[convention.up].replace('-', ' is ')}")
    if convention.inverse != stated.inverse:
        says.append("the rotation leads from the world to the body")
    return ", ".join(says)


def _axes(word: str) -> str:
    try:
        frd_from_axes(word, left_handed=True)
    except ValueError:
        hint = "give words as xyzw, flu, z-up, deg, inverse"
        raise InputError(f"--convention {word[:30]}", "is not known", hint) from None
    return word


def _of_angles(angles: Floats) -> Floats:
    return rotation_from_rpy(*angles.tolist())

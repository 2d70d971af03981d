"""Every kind of camera file, found by its fields. A new one is a module and a line here."""

from collections.abc import Sequence
from pathlib import Path
from typing import Protocol

from horizon_dl.calibration import (
    autoware,
    basalt,
    colmap,
    euroc,
    kalibr,
    opencv,
    orb_slam,
    own,
    ros,
    vins,
)
from horizon_dl.calibration.candidate import Candidate, Wanted
from horizon_dl.calibration.fields import Fields, Tree
from horizon_dl.errors import InputError


class Family(Protocol):
    """What the module of a kind of file offers."""

    NAME: str

    def recognises(self, tree: Tree) -> bool:
        """Whether the fields are of this kind."""

    def candidates(self, fields: Fields, wanted: Wanted) -> list[Candidate]:
        """The cameras of the file."""


FAMILIES: Sequence[Family] = (colmap, kalibr, basalt, vins, orb_slam, euroc, autoware, ros, opencv, own)
"""The first that recognises a file reads it: those with names of their own before those with common ones."""


def family_of(path: Path, tree: Tree) -> Family:
    """The kind of a file; InputError, with the fields found, where none is known."""
    for family in FAMILIES:
        if family.recognises(tree):
            return family
    names = ", ".join(" ".join(name[:30].split()) for name in list(tree)[:6])
    more = ", ..." if len(tree) > 6 else ""
    kinds = ", ".join(family.NAME for family in FAMILIES)
    raise InputError(
        path, f"is no known kind of camera file (fields found: {names}{more})", f"known: {kinds}"
    )

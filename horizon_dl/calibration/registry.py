"""Every kind of camera file, found by its fields. A new one is a module and a line here."""

from collections.abc import Sequence
from dataclasses import replace
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


DEEPEST, MOST_SECTIONS = 3, 50
"""How far below the top a file's cameras are looked for, and in how many sections of a level."""


def family_of(tree: Tree) -> Family | None:
    """The kind of a file or of a section of it, or None."""
    return next((family for family in FAMILIES if family.recognises(tree)), None)


def cameras_in(fields: Fields, wanted: Wanted) -> list[Candidate]:
    """The cameras of a file, or of its sections, which are then named after these.

    Raises:
        InputError: of no known kind; the fields found are named.
    """
    found = _cameras_in(fields, wanted, DEEPEST)
    if found:
        return found
    tree = fields.content
    names = ", ".join(" ".join(name[:30].split()) for name in list(tree)[:6])
    more = ", ..." if len(tree) > 6 else ""
    kinds = ", ".join(family.NAME for family in FAMILIES)
    raise InputError(
        fields.path, f"is no known kind of camera file (fields found: {names}{more})", f"known: {kinds}"
    )


def _cameras_in(fields: Fields, wanted: Wanted, levels: int) -> list[Candidate]:
    family = family_of(fields.content)
    if family is not None:
        return family.candidates(fields, wanted)
    found = []
    sections = [str(name) for name, value in fields.content.items() if isinstance(value, dict)]
    for name in sections[:MOST_SECTIONS] if levels else []:
        for one in _cameras_in(fields.section(name), wanted, levels - 1):
            found.append(replace(one, names=(name, *one.names)))
    return found

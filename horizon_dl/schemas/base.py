"""The common part: a version, checked types, and one line where a file is something else."""

import json
from pathlib import Path
from typing import Any, ClassVar, Self

from pydantic import BaseModel, ConfigDict, ValidationError

from horizon_dl.errors import InputError


class Part(BaseModel):
    """A part of a file. Keys are added over time, never renamed: unknown ones are kept."""

    model_config = ConfigDict(extra="allow", frozen=True, populate_by_name=True)


class Versioned(Part):
    """A file with a version of its own in the key `schema`.

    Attributes:
        VERSION: the newest that is read.
        FILE: the file's usual name.
    """

    VERSION: ClassVar[int] = 1
    FILE: ClassVar[str]

    @classmethod
    def parse(cls, tree: Any, where: str | Path) -> Self:
        """The checked content of a file.

        Raises:
            InputError: it has another version, or a key is missing or of another type.
        """
        version = tree.get("schema", 1) if isinstance(tree, dict) else None
        if version != cls.VERSION:
            problem = f"has the version {str(version)[:20]!r}; this program reads {cls.VERSION}"
            raise InputError(where, problem, "use the program that wrote it, or make it again")
        try:
            return cls.model_validate(tree)
        except ValidationError as error:
            first = error.errors(include_input=False, include_url=False)[0]
            key = ".".join(str(part) for part in first["loc"])
            raise InputError(where, f"key {key}: {first['msg']}"[:200], "make the file again") from None

    @classmethod
    def read(cls, path: Path) -> Self:
        """The checked content of a JSON file; InputError as `parse`, and where it is no JSON."""
        try:
            tree = json.loads(path.read_text(encoding="utf-8"))
        except FileNotFoundError:
            raise InputError(path, "does not exist", f"give a {cls.FILE}") from None
        except (OSError, ValueError, RecursionError):
            raise InputError(path, "cannot be read as JSON", "make the file again") from None
        return cls.parse(tree, path)

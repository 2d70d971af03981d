"""What a folder of results holds, who made it, and the SHA-256 of every file: `manifest.json`."""

import hashlib
import json
from dataclasses import dataclass, field
from pathlib import Path

from horizon_dl import __version__
from horizon_dl.errors import InputError
from horizon_dl.output.files import write_text

MANIFEST = "manifest.json"
MADE_BY = "horizon-dl"
MOST_BYTES = 64 * 2**20


@dataclass(frozen=True)
class Manifest:
    """The content of `manifest.json`.

    Attributes:
        kind: the verb whose results these are.
        files: SHA-256 by path relative to the folder, of files that no longer change.
    """

    kind: str
    files: dict[str, str] = field(default_factory=dict)

    def text(self) -> str:
        """As it is written; the last entry is the SHA-256 of the rest, so that no damage passes."""
        head = {"schema": 1, "made_by": MADE_BY, "version": __version__, "kind": self.kind}
        body = {**head, "files": dict(sorted(self.files.items()))}
        return json.dumps({**body, "sha256": _hash_of(body)}, indent=1) + "\n"


def write_manifest(folder: Path, manifest: Manifest) -> None:
    """Write it into a folder that exists."""
    write_text(folder / MANIFEST, manifest.text())


def read_manifest(folder: Path) -> Manifest | None:
    """The manifest of a folder; None where there is none.

    Raises:
        InputError: it is damaged.
    """
    path = folder / MANIFEST
    damaged = InputError(path, "is damaged", "make the results anew, in another folder or with --overwrite")
    try:
        if not path.is_file() or path.stat().st_size > MOST_BYTES:
            return None
        text = path.read_bytes().decode()
        content = json.loads(text)
    except (OSError, ValueError, RecursionError):
        raise damaged from None
    if not isinstance(content, dict) or content.get("made_by") != MADE_BY:
        if MADE_BY in text or '"sha256"' in text:
            raise damaged
        return None  # another program's
    digest = content.pop("sha256", None)
    # Compared as text, too: a damage that JSON reads over, as in a blank, is one all the same.
    whole = json.dumps({**content, "sha256": digest}, indent=1) + "\n"
    files, kind = content.get("files"), content.get("kind")
    if _hash_of(content) != digest or whole != text or not isinstance(files, dict):
        raise damaged
    return Manifest(str(kind), {str(name): str(value) for name, value in files.items()})


def hashes(folder: Path) -> dict[str, str]:
    """SHA-256 of every file below a folder but its manifest, by relative path."""
    paths = sorted(path for path in folder.rglob("*") if path.is_file())
    names = {path.relative_to(folder).as_posix(): path for path in paths}
    return {name: file_hash(path) for name, path in names.items() if name != MANIFEST}


def check_files(folder: Path, names: tuple[str, ...], hint: str) -> None:
    """The files are what the folder's manifest says; a folder of an older version has none.

    Raises:
        InputError: one of them, or the manifest, is damaged.
    """
    manifest = read_manifest(folder)
    if manifest is None:
        return
    for name in names:
        known = manifest.files.get(name)
        if known is not None and file_hash(folder / name) != known:
            raise InputError(folder / name, "is damaged or was altered (its SHA-256 does not fit)", hint)


def file_hash(path: Path) -> str:
    """SHA-256 of a file, in hexadecimal."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def held_by(folder: Path) -> list[str]:
    """Names in a folder that stand for something: hidden ones and what file systems add do not."""
    ignored = {"lost+found"}
    names = (path.name for path in folder.iterdir())
    return sorted(name for name in names if not name.startswith(".") and name not in ignored)


def _hash_of(body: object) -> str:
    return hashlib.sha256(json.dumps(body).encode()).hexdigest()

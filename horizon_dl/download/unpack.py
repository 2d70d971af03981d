"""Unpacks archives that are not trusted: nothing is written outside the target folder."""

import lzma
import stat
import struct
import tarfile
import zipfile
import zlib
from pathlib import Path, PurePosixPath

from horizon_dl.errors import InputError

MOST_GROWTH = 100
LEAST_GROWN = 10**8
DAMAGED = (
    zipfile.BadZipFile,
    tarfile.TarError,
    zlib.error,
    lzma.LZMAError,
    struct.error,
    EOFError,
    RuntimeError,  # encrypted
    NotImplementedError,
    ValueError,
    LookupError,
    TypeError,
    OverflowError,
    MemoryError,
)
"""What `zipfile` and `tarfile` raise for damaged and encrypted archives."""


def unpack(archive: Path, target: Path, inside: str | None = None) -> None:
    """Unpacks a .zip, .tgz or .tar.gz into a folder.

    Args:
        archive: the file; its name tells its kind.
        target: folder, made where needed.
        inside: file name of an archive within the archive; only that one is unpacked.

    Raises:
        InputError: damaged, of another kind, a member would land outside `target`, the disk is full, or there
            is no member called `inside`.
    """
    try:
        if inside is not None:
            nested = _take_out(archive, inside)
            unpack(nested, target)
            nested.unlink()
        elif archive.suffix == ".zip":
            _unzip(archive, target)
        elif archive.name.endswith((".tgz", ".tar.gz")):
            with tarfile.open(archive) as tar:
                tar.extractall(target, filter=_Growth(archive))
        else:
            raise InputError(archive.name, "is no .zip, .tgz or .tar.gz", "unpack it by hand")
    except tarfile.FilterError as error:
        raise _unsafe(archive, str(error)) from None
    except DAMAGED as error:
        encrypted = "encrypted" in str(error) or "password" in str(error)
        kind = "is encrypted" if encrypted else f"is a damaged archive ({type(error).__name__})"
        raise InputError(archive.name, kind, "fetch it again") from None
    except OSError as error:
        problem = f"cannot be unpacked ({error.strerror or error})"
        raise InputError(archive.name, problem, "free space or give another --out") from None


class _Growth:
    """Ends the unpacking of an archive that grows more than images and text ever do."""

    def __init__(self, archive: Path) -> None:
        self._archive = archive
        self._left = max(LEAST_GROWN, MOST_GROWTH * archive.stat().st_size)

    def __call__(self, member: tarfile.TarInfo, target: str) -> tarfile.TarInfo:
        """A filter for `tarfile`, which is also that for data."""
        self.add(member.size)
        return tarfile.data_filter(member, target)

    def add(self, size: int) -> None:
        """One more member."""
        self._left -= size
        if self._left < 0 or size < 0:
            raise InputError(self._archive.name, "would grow beyond all measure", "do not use it")


def _unsafe(archive: Path, member: str) -> InputError:
    return InputError(archive.name, f"holds a member that leaves the folder ({member})", "do not use it")


def _unzip(archive: Path, target: Path) -> None:
    with zipfile.ZipFile(archive) as zipped:
        growth = _Growth(archive)
        for member in zipped.infolist():
            growth.add(member.file_size)
            path = PurePosixPath(member.filename.replace("\\", "/"))
            is_link = stat.S_ISLNK(member.external_attr >> 16)
            if path.is_absolute() or ".." in path.parts or is_link:
                raise _unsafe(archive, member.filename)
        zipped.extractall(target)


def _take_out(archive: Path, inside: str) -> Path:
    """Copies the member of that file name beside the archive."""
    with zipfile.ZipFile(archive) as zipped:
        for member in zipped.infolist():
            if PurePosixPath(member.filename).name == inside:
                member.filename = inside
                return Path(zipped.extract(member, archive.parent))
    raise InputError(archive.name, f"holds no {inside}", "look at the set's page")

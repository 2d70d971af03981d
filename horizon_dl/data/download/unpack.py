"""Unpacks archives that are not trusted: nothing is written outside the target folder."""

import stat
import tarfile
import zipfile
from pathlib import Path, PurePosixPath

from horizon_dl.errors import InputError


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
                tar.extractall(target, filter="data")
        else:
            raise InputError(archive.name, "is no .zip, .tgz or .tar.gz", "unpack it by hand")
    except tarfile.FilterError as error:
        raise _unsafe(archive, str(error)) from None
    except (zipfile.BadZipFile, tarfile.TarError, EOFError) as error:
        raise InputError(archive.name, f"is a damaged archive ({error})", "fetch it again") from None
    except OSError as error:
        problem = f"cannot be unpacked ({error.strerror or error})"
        raise InputError(archive.name, problem, "free space or give another --out") from None


def _unsafe(archive: Path, member: str) -> InputError:
    return InputError(archive.name, f"holds a member that leaves the folder ({member})", "do not use it")


def _unzip(archive: Path, target: Path) -> None:
    with zipfile.ZipFile(archive) as zipped:
        for member in zipped.infolist():
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

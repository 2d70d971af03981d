"""Fetches a public set: download, check the hash, unpack, rename."""

import shutil
import tempfile
from collections.abc import Callable
from pathlib import Path

from horizon_dl.data.regular_file import read_regular
from horizon_dl.download.download import download
from horizon_dl.download.public_sets import Archive, PublicSet, find_set
from horizon_dl.download.unpack import unpack
from horizon_dl.errors import InputError

SUMS = "SHA256SUMS"
MOST_SUMS = 2**20


def fetch(
    name: str,
    out: Path,
    *,
    base_url: str | None = None,
    progress: bool = False,
    say: Callable[[str], None] = print,
) -> Path:
    """Fetches a set into `out/NAME`, unless it is there already.

    Every archive is hashed. Where the registry knows the SHA-256, another one is an error. Where it does not,
    `say` tells the hash, `out/SHA256SUMS` keeps it, and a later fetch must find the same again: the first
    download is taken on trust, the later ones are not.

    Args:
        name: of the registry.
        out: folder that holds fetched sets.
        base_url: take the files from here instead of the official host; hashes are checked all the same.
        progress: show bars.
        say: takes lines for the user.

    Returns:
        The folder to give to the other verbs.

    Raises:
        InputError: unknown name, no network, wrong hash, damaged archive, full disk. Nothing half-fetched
            stays.
    """
    known = find_set(name)
    if not known.archives:
        raise InputError(name, "is not downloaded but made here", "run: horizon-dl data simulate")
    target = out / name
    if target.exists():
        say(f"{target} is there already; remove it to fetch it again")
        return _opened(known, target)
    beside, made = _workplace(out, name)
    try:
        sums = _read_sums(out / SUMS)
        for archive in known.archives:
            _fetch_archive(known, archive, beside, sums, base_url, progress, say)
        _opened(known, beside / "set")
        _write_sums(out / SUMS, sums)
        (beside / "set").rename(target)
    except BaseException:
        shutil.rmtree(beside, ignore_errors=True)
        if made and not any(out.iterdir()):
            out.rmdir()
        raise
    shutil.rmtree(beside, ignore_errors=True)
    return _opened(known, target)


def _workplace(out: Path, name: str) -> tuple[Path, bool]:
    """A folder within `out` to work in, and whether `out` was made for it."""
    made = not out.exists()
    try:
        out.mkdir(parents=True, exist_ok=True)
        return Path(tempfile.mkdtemp(prefix=f".{name}.", dir=out)), made
    except OSError as error:
        raise InputError(out, f"cannot be written ({error.strerror})", "give another --out") from None


def _fetch_archive(
    known: PublicSet,
    archive: Archive,
    beside: Path,
    sums: dict[str, str],
    base_url: str | None,
    progress: bool,
    say: Callable[[str], None],
) -> None:
    url = f"{base_url.rstrip('/')}/{archive.file}" if base_url else archive.url
    file = beside / archive.file
    found = download(url, file, page=known.page, progress=progress)
    expected = archive.sha256 or sums.get(archive.file)
    if expected is None:
        say(f"{archive.file}: no published hash to check against; SHA-256 {found} kept in {SUMS}")
    elif found != expected:
        problem = f"has SHA-256 {found} instead of {expected}"
        raise InputError(url, problem, f"do not use it; try again or look at {known.page}")
    sums[archive.file] = found
    unpack(file, beside / "set", archive.inside)
    file.unlink()


def _opened(known: PublicSet, folder: Path) -> Path:
    opened = folder / known.opens
    if not opened.is_dir():
        raise InputError(folder, f"holds no {known.opens}", "remove it and fetch the set again")
    return opened


def _read_sums(path: Path) -> dict[str, str]:
    """File name to hash, from lines as `sha256sum` writes them."""
    if not path.exists():
        return {}
    lines = read_regular(path, MOST_SUMS).splitlines()
    pairs = [line.split(maxsplit=1) for line in lines if line.strip()]
    if any(len(pair) != 2 or len(pair[0]) != 64 for pair in pairs):
        raise InputError(path, "is not a list of SHA-256 sums", "remove it")
    return {file.lstrip("*"): digest for digest, file in pairs}


def _write_sums(path: Path, sums: dict[str, str]) -> None:
    beside = path.with_name(f".{path.name}.partial")
    beside.write_text("".join(f"{digest}  {file}\n" for file, digest in sorted(sums.items())))
    beside.replace(path)

"""Streams a file from the web to disk, hashing it on the way."""

import hashlib
import http.client
import urllib.error
import urllib.request
from pathlib import Path
from typing import Any

from horizon_dl.errors import InputError
from horizon_dl.progress import show_progress

_AGENT = "horizon-dl (data fetch)"  # some hosts refuse Python's own name
_BLOCK = 1 << 18


def download(url: str, target: Path, *, page: str, progress: bool = False, timeout_s: float = 60.0) -> str:
    """Downloads a file.

    Args:
        url: http or https.
        target: file to write.
        page: where a person finds the file, for the error message.
        progress: show a bar.
        timeout_s: seconds without an answer before giving up.

    Returns:
        The SHA-256 of what was written, in hexadecimal.

    Raises:
        InputError: the host cannot be reached or refuses, the transfer breaks off, the disk is full.
    """
    request = urllib.request.Request(url, headers={"User-Agent": _AGENT})
    try:
        with urllib.request.urlopen(request, timeout=timeout_s) as answer:
            return _stream(answer, url, target, progress)
    except urllib.error.HTTPError as error:
        problem = f"the host answers {error.code} {error.reason}"
        raise InputError(url, problem, f"look at {page} for where it is now") from None
    except (urllib.error.URLError, TimeoutError, ConnectionError, http.client.HTTPException) as error:
        reason = getattr(error, "reason", None) or error or type(error).__name__
        raise InputError(url, f"cannot be reached ({reason})", "check the network and try again") from None
    except OSError as error:
        problem = f"cannot be written ({error.strerror or error})"
        raise InputError(target, problem, "free space or give another --out") from None


def _stream(answer: Any, url: str, target: Path, progress: bool) -> str:
    digest, done = hashlib.sha256(), 0
    length = answer.headers.get("Content-Length")
    total = int(length) if length else None
    bar = show_progress(what=target.name, total=total, unit="B", unit_scale=True, disable=not progress)
    with target.open("wb") as stream, bar:
        while block := answer.read(_BLOCK):
            stream.write(block)
            digest.update(block)
            done += len(block)
            bar.update(len(block))
    if total is not None and done != total:
        raise InputError(url, f"broke off after {done} of {total} bytes", "try again")
    return digest.hexdigest()

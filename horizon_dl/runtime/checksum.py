"""The seal of a model file: says what it is, how long it is, and whether it is what was exported.

The seal is the document string of the ONNX file, which stands at its beginning, so it is found without
parsing. It guards against files that are cut off, damaged or edited; it is no signature of its maker.
"""

import hashlib
import re
from pathlib import Path

from horizon_dl.data.regular_file import check_regular
from horizon_dl.errors import InputError

FORMAT = 1
BLANK = f"horizon-dl obstacle model, format {FORMAT}, bytes {0:010d}, sha256 {0:064x}"
_SEAL = re.compile(rb"horizon-dl obstacle model, format (\d+), bytes (\d{10}), sha256 ([0-9a-f]{64})")
_HEAD = 4096
MOST_BYTES = 2**30
_WAY_OUT = "export it again with `horizon-dl export`"


def sealed(blank_file: bytes) -> bytes:
    """The bytes of a file that holds the `BLANK` seal, with length and hash filled in.

    The hash is that of the whole file with 64 zeros in place of the hash.
    """
    if blank_file.count(BLANK.encode()) != 1:
        raise ValueError("the file must hold the blank seal once")
    with_size = f"horizon-dl obstacle model, format {FORMAT}, bytes {len(blank_file):010d}, sha256 {0:064x}"
    unsigned = blank_file.replace(BLANK.encode(), with_size.encode())
    digest = hashlib.sha256(unsigned).hexdigest()
    return unsigned.replace(with_size.encode(), with_size.encode()[:-64] + digest.encode())


def read_sealed(path: Path) -> tuple[bytes, str]:
    """The bytes of a model file, and its hash.

    Raises:
        InputError: no such file, another kind of file, a newer format, cut off, or altered.
    """
    try:
        check_regular(path, MOST_BYTES)
        content = path.read_bytes()
    except OSError as error:
        problem = (
            "does not exist" if isinstance(error, FileNotFoundError) else f"cannot be read ({error.strerror})"
        )
        raise InputError(path, problem, "give a file that `horizon-dl export` wrote") from None
    found = _SEAL.search(content[:_HEAD])
    if found is None:
        raise InputError(path, "is no obstacle model of horizon-dl", "give what `horizon-dl export` wrote")
    version, size, digest = (group.decode() for group in found.groups())
    if int(version) != FORMAT:
        problem = f"has format {version}, this version reads format {FORMAT}"
        raise InputError(path, problem, "install the version of horizon-dl that wrote it")
    if int(size) != len(content):
        kind = "is cut off" if len(content) < int(size) else "has grown"
        raise InputError(path, f"{kind} ({len(content)} of {int(size)} bytes)", _WAY_OUT)
    start, end = found.span(3)
    if hashlib.sha256(content[:start] + b"0" * 64 + content[end:]).hexdigest() != digest:
        raise InputError(path, "was altered or is damaged (its hash does not fit)", _WAY_OUT)
    return content, digest

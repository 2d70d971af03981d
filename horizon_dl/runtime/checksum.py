"""The seal of a model file: says what it is, how long it is, and whether it is what was exported.

The seal is the document string of the ONNX file, which stands at its beginning, so it is found without
parsing. It guards against files that are cut off, damaged or edited. In a signed file (format 2) the maker's
signature follows; see `signature`.
"""

import hashlib
import re
from pathlib import Path

from horizon_dl.data.regular_file import check_regular
from horizon_dl.errors import InputError
from horizon_dl.runtime.signature import Signer, Verifier

FORMAT, SIGNED = 1, 2
BLANK = f"horizon-dl obstacle model, format {FORMAT}, bytes {0:010d}, sha256 {0:064x}"
BLANK_SIGNED = (
    f"horizon-dl obstacle model, format {SIGNED}, bytes {0:010d}, sha256 {0:064x}, ed25519 {0:0128x}"
)
_SEAL = re.compile(
    rb"horizon-dl obstacle model, format (\d{1,9}), bytes (\d{10}), sha256 ([0-9a-f]{64})"
    rb"(?:, ed25519 ([0-9a-f]{128}))?"
)
_HEAD = 4096
MOST_BYTES = 2**30
_WAY_OUT = "export it again with `horizon-dl export`"


def checksummed(blank_file: bytes, sign: Signer | None = None) -> bytes:
    """The bytes of a file that holds the `BLANK` seal, with length and hash filled in.

    The hash is that of the whole file with zeros in place of hash and signature.

    Args:
        blank_file: with `BLANK`, or with `BLANK_SIGNED` if it is to be signed.
        sign: gives the signature of the hash.
    """
    blank = (BLANK if sign is None else BLANK_SIGNED).encode()
    if blank_file.count(blank) != 1:
        raise ValueError("the file must hold the blank seal once")
    start = blank_file.index(blank)
    size = b"bytes %010d" % len(blank_file)
    unsigned = blank_file.replace(blank, blank.replace(b"bytes %010d" % 0, size))
    digest = hashlib.sha256(unsigned).hexdigest()
    seal = unsigned[start : start + len(blank)].replace(b"sha256 " + b"0" * 64, b"sha256 " + digest.encode())
    if sign is not None:
        seal = seal[:-128] + sign(digest).hex().encode()
    return unsigned[:start] + seal + unsigned[start + len(blank) :]


def read_checksummed(path: Path, trusted: Verifier | None = None) -> tuple[bytes, str]:
    """The bytes of a model file, and its hash.

    Args:
        path: of the file.
        trusted: knows the signatures of the one who is trusted; None: everybody is.

    Raises:
        InputError: no such file, another kind of file, a newer format, cut off, altered, or not signed by the
            one who is trusted.
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
    version, size, digest = (group.decode() for group in found.groups()[:3])
    signature = found[4]
    if int(version) not in (FORMAT, SIGNED):
        problem = f"has format {version}, this version reads formats {FORMAT} and {SIGNED}"
        raise InputError(path, problem, "install the version of horizon-dl that wrote it")
    if int(size) != len(content):
        kind = "is cut off" if len(content) < int(size) else "has grown"
        raise InputError(path, f"{kind} ({len(content)} of {int(size)} bytes)", _WAY_OUT)
    blank = bytearray(content)
    for group in (3, 4) if int(version) == SIGNED and signature else (3,):
        start, end = found.span(group)
        blank[start:end] = b"0" * (end - start)
    if hashlib.sha256(blank).hexdigest() != digest:
        raise InputError(path, "was altered or is damaged (its hash does not fit)", _WAY_OUT)
    if trusted is not None:
        if int(version) != SIGNED or signature is None:
            raise InputError(path, "is not signed", "export it with --sign, or fly without --trust")
        if not trusted(digest, bytes.fromhex(signature.decode())):
            raise InputError(path, "is not signed by the one who is trusted", "do not fly it")
    return content, digest

"""Ed25519 signatures of model files: who made a file, for those who want to know it.

Keys are PEM files, as `openssl genpkey -algorithm ed25519 -out KEY` and `openssl pkey -in KEY -pubout -out
PUBKEY` write them. What is signed is the file's SHA-256, which covers all of it.
"""

from collections.abc import Callable
from pathlib import Path
from typing import Any

from horizon_dl.data.regular_file import read_regular
from horizon_dl.errors import InputError

MOST_BYTES = 16 * 1024
PURPOSE = b"horizon-dl obstacle model, sha256 "
"""Stands before the hash: a signature for something else never fits a model file."""
MAKE_KEY = "make one with `openssl genpkey -algorithm ed25519 -out KEY`"

Signer = Callable[[str], bytes]
Verifier = Callable[[str, bytes], bool]


def read_signer(path: Path) -> Signer:
    """What signs the hash of a file with a private key.

    Raises:
        InputError: the file holds no Ed25519 private key without a pass phrase.
        ModuleNotFoundError: the extra `sign` is not installed.
    """
    from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey
    from cryptography.hazmat.primitives.serialization import load_pem_private_key

    key = _read(path, lambda pem: load_pem_private_key(pem, password=None))
    if not isinstance(key, Ed25519PrivateKey):
        raise InputError(path, "holds no Ed25519 private key", MAKE_KEY)
    return lambda digest: key.sign(PURPOSE + digest.encode())


def read_verifier(path: Path) -> Verifier:
    """What tells whether a hash was signed with the private key that belongs to a public one.

    Raises:
        InputError: the file holds no Ed25519 public key.
        ModuleNotFoundError: the extra `sign` is not installed.
    """
    from cryptography.exceptions import InvalidSignature
    from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PublicKey
    from cryptography.hazmat.primitives.serialization import load_pem_public_key

    key = _read(path, load_pem_public_key)
    if not isinstance(key, Ed25519PublicKey):
        raise InputError(
            path, "holds no Ed25519 public key", "make it with `openssl pkey -in KEY -pubout -out PUBKEY`"
        )

    def verify(digest: str, signature: bytes) -> bool:
        try:
            key.verify(signature, PURPOSE + digest.encode())
        except InvalidSignature:
            return False
        return True

    return verify


def _read(path: Path, load: Callable[[bytes], Any]) -> Any:
    """A key, or None; what the library says of a damaged one may hold parts of it and is not repeated."""
    try:
        return load(read_regular(path, MOST_BYTES).encode())
    except FileNotFoundError:
        raise InputError(path, "does not exist", MAKE_KEY) from None
    except (ValueError, TypeError):
        return None
    except Exception as error:
        if type(error).__name__ == "UnsupportedAlgorithm":
            return None
        raise

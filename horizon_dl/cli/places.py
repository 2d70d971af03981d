"""Wrong paths, told before anything heavy is loaded."""

import argparse
import re
from pathlib import Path

from horizon_dl.data.regular_file import check_there
from horizon_dl.errors import InputError

FROM = ("data", "source", "run_folder", "model", "models", "camera", "forest", "signing_key", "trust", "sign")
"""Arguments of any verb that name something to read."""
ADDRESS = re.compile(r"[A-Za-z][A-Za-z0-9+.-]*:")
"""How cameras, streams and autopilots begin; a file so named can be given as ./NAME."""

RESUMABLE = ("online", "train")
"""Verbs that go on in a folder of their own, and look into it themselves."""
TO_A_FILE = ("benchmark",)
"""Verbs whose --out is one file, which they check themselves."""


def check_places(arguments: argparse.Namespace) -> None:
    """What is to be read is there, and where is to be written can be: as far as a look can tell.

    Raises:
        InputError: if not.
    """
    for name in FROM:
        given = getattr(arguments, name, None)
        for one in given if isinstance(given, list) else [given]:
            if one is not None and not ADDRESS.match(str(one)):
                check_there(Path(one))
    out = getattr(arguments, "out", None)
    if out is not None and hasattr(arguments, "overwrite") and arguments.verb not in TO_A_FILE:
        _check_out(out, arguments.overwrite, resuming=arguments.verb in RESUMABLE)


def _check_out(out: Path, overwrite: bool, resuming: bool) -> None:
    import tempfile

    from horizon_dl.output.folder import check_free

    try:
        if out.exists() and not out.is_dir():
            raise InputError(out, "is a file", "give a folder with --out")
        if not (overwrite or resuming):
            check_free(out)
        there = next(folder for folder in (out.absolute(), *out.absolute().parents) if folder.exists())
        with tempfile.TemporaryFile(dir=there):
            pass
    except OSError as error:
        raise InputError(out, f"cannot be written ({error.strerror})", "give another --out") from None

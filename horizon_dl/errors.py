"""The exceptions that leave this package: what a caller, or the command line, has to know of."""

from pathlib import Path

LONGEST_PART = 1200
"""Characters of a file name, a problem or a hint in a message; a path of the system's longest is cut."""


class HorizonError(Exception):
    """Base of all errors that public functions raise on purpose."""


class InputError(HorizonError):
    """Input that the user has to fix: one line with the file, the problem and a hint (exit code 2).

    Example:
        >>> str(InputError("camera.yaml", "has no field 'fx'", "add the focal length in pixels"))
        "camera.yaml: has no field 'fx'; add the focal length in pixels"
    """

    def __init__(self, where: str | Path, problem: str, hint: str) -> None:
        super().__init__(where, problem, hint)  # all of it, so that it can travel between processes

    def __str__(self) -> str:
        return "{}: {}; {}".format(*(shortened(printable(part)) for part in self.args))


class FrameError(InputError):
    """One frame that cannot be read; sets go on without it and count it."""


def printable(text: object) -> str:
    r"""The text on one line, with everything that moves a cursor, rings or cannot be encoded made visible.

    Names of files come from strangers and end on a terminal.

    Example:
        >>> print(printable("a\x1b[2Jb\nc"))
        a\x1b[2Jb\nc
    """
    return "".join(
        letter if letter.isprintable() else letter.encode("unicode_escape").decode() for letter in str(text)
    )


def shortened(text: str, longest: int = LONGEST_PART) -> str:
    """The text, or its two ends where it is too long for a message."""
    if len(text) <= longest:
        return text
    return f"{text[: longest // 2]}...{text[-(longest // 2) :]}"

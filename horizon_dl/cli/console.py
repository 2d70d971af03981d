"""How loud a verb is: `--quiet`, `-v`, `--json`, and colours where a terminal shows them."""

import argparse
import json
import os
import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, redirect_stdout
from pathlib import Path
from typing import IO, Any

COLOURS = {"problem": "31", "warning": "33", "ok": "32", "error": "1;31"}


def add_console(parser: argparse.ArgumentParser) -> None:
    """`--quiet`, `-v` and `--json`."""
    group = parser.add_mutually_exclusive_group()
    # Suppressed where they are not given: an action of a verb must not undo what stands before it.
    group.add_argument(
        "-q", "--quiet", action="store_true", default=argparse.SUPPRESS, help="warnings and errors alone"
    )
    group.add_argument(
        "-v",
        "--verbose",
        action="store_true",
        default=argparse.SUPPRESS,
        help="also versions, changed config values, the time taken, and where a failure happened",
    )
    parser.add_argument(
        "--json",
        action="store_true",
        default=argparse.SUPPRESS,
        help="results as one JSON object on standard output; all else goes to standard error",
    )


def is_verbose(arguments: argparse.Namespace) -> bool:
    """Whether `-v` was given."""
    return bool(getattr(arguments, "verbose", False))


@contextmanager
def console(arguments: argparse.Namespace) -> Iterator[None]:
    """Standard output and progress bars as the options ask for; all is put back at the end."""
    start_s = time.monotonic()
    with ExitStack() as stack:
        if getattr(arguments, "quiet", False):
            stack.enter_context(_no_bars())
            stack.enter_context(redirect_stdout(stack.enter_context(Path(os.devnull).open("w"))))
        elif getattr(arguments, "json", False):
            stack.enter_context(redirect_stdout(sys.stderr))
        try:
            yield
        finally:
            if is_verbose(arguments):
                say(_versions())
                say(f"{arguments.verb} took {time.monotonic() - start_s:.1f} s")


def say(line: str) -> None:
    """A line beside the results."""
    print(line, file=sys.stderr, flush=True)


def write_result(arguments: argparse.Namespace, result: dict[str, Any]) -> None:
    """The one object of `--json`; nothing without that option."""
    if getattr(arguments, "json", False):
        print(json.dumps({"verb": arguments.verb, **_plain(result)}, allow_nan=False), flush=True)


def coloured(text: str, kind: str, stream: IO[str]) -> str:
    """The text in the colour of its kind, where the stream is a terminal and NO_COLOR is not set."""
    plain = os.environ.get("NO_COLOR") or os.environ.get("TERM") == "dumb" or not stream.isatty()
    return text if plain else f"\x1b[{COLOURS[kind]}m{text}\x1b[0m"


def with_level(line: str, stream: IO[str]) -> str:
    """A line that begins with a finding's level, such as `warning`, with that word coloured.

    Example:
        >>> with_level("warning: too dark", open(os.devnull, "w"))
        'warning: too dark'
    """
    word = line.partition(" ")[0].rstrip(":")
    return coloured(word, word, stream) + line[len(word) :] if word in COLOURS else line


@contextmanager
def _no_bars() -> Iterator[None]:
    before = os.environ.get("TQDM_DISABLE")
    os.environ["TQDM_DISABLE"] = "1"
    try:
        yield
    finally:
        if before is None:
            del os.environ["TQDM_DISABLE"]
        else:
            os.environ["TQDM_DISABLE"] = before


def _versions() -> str:
    from horizon_dl.provenance import versions

    return ", ".join(f"{name} {number}" for name, number in versions().items())


def _plain(value: Any) -> Any:
    """What JSON knows: paths as text, numbers that are none as null."""
    if isinstance(value, dict):
        return {str(key): _plain(one) for key, one in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(one) for one in value]
    if value is None or isinstance(value, bool | int | str):
        return value
    if isinstance(value, Path):
        return str(value)
    number = float(value)
    return number if abs(number) < float("inf") else None

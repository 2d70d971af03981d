"""Options of the verbs that can be watched while they run. A new viewer is one line in `open_viewers`."""

import argparse
import os
import sys
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from horizon_dl.visualization.sink import Sink


def add_viewers(parser: argparse.ArgumentParser) -> None:
    """`--serve`, `--show` and `--rerun`."""
    parser.add_argument(
        "--serve",
        metavar="[HOST:]PORT",
        help="a live page; only for this machine unless a HOST is given, then with a token",
    )
    parser.add_argument("--show", action="store_true", help="open the live page in a window of this machine")
    parser.add_argument(
        "--rerun", metavar="FILE.rrd|connect", help="for the rerun viewer (extra `viz`): a file, or live"
    )


def open_viewers(
    arguments: argparse.Namespace, title: str, status: Callable[[], dict[str, Any]]
) -> "list[Sink]":
    """The viewers that were asked for.

    Raises:
        InputError: one of them cannot be opened.
    """
    sinks: list[Sink] = []
    if arguments.serve is not None or arguments.show:
        sinks.append(_live_page(arguments, title, status))
    if arguments.rerun is not None:
        from horizon_dl.visualization.newest_only import NewestOnly
        from horizon_dl.visualization.rerun_sink import Rerun

        sinks.append(NewestOnly(Rerun(arguments.rerun, title)))
    return sinks


def _live_page(arguments: argparse.Namespace, title: str, status: Callable[[], dict[str, Any]]) -> "Sink":
    import webbrowser

    from horizon_dl.errors import InputError
    from horizon_dl.visualization.live_page import Address, LivePage

    if arguments.show and not has_screen():
        raise InputError(
            "--show", "there is no screen here", "look from another machine with --serve HOST:PORT"
        )
    page = LivePage(Address.parse(arguments.serve or "0"), title, status)
    print(f"live at {page.url}", flush=True)
    if arguments.show:
        webbrowser.open(page.url)
    return page


def has_screen() -> bool:
    """Whether a window can be opened."""
    if sys.platform in ("darwin", "win32"):
        return True
    return bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))

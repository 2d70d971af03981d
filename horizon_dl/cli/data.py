"""Public data sets, and simulated worlds.

horizon-dl data list                      what can be fetched
horizon-dl data fetch NAME --out DIR      from its official host, checked by hash
horizon-dl data simulate --out DIR        a new flight through a simulated world (needs the extra 'sim')
"""

import argparse
from pathlib import Path
from typing import Any

from horizon_dl.cli.console import add_console
from horizon_dl.cli.next_command import next_command
from horizon_dl.cli.options import positive_int
from horizon_dl.simulation.kinds import KINDS


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the verb."""
    actions = parser.add_subparsers(dest="action", metavar="ACTION", required=True)
    actions.add_parser("list", help="what can be fetched")
    fetch = actions.add_parser("fetch", help="download a public set")
    fetch.add_argument("name", metavar="NAME")
    fetch.add_argument("--out", type=Path, metavar="DIR", help="where to write (default: NAME)")
    simulate = actions.add_parser("simulate", help="render a flight through a simulated world")
    simulate.add_argument(
        "--out", type=Path, default=Path("simulated"), metavar="DIR", help="(default: simulated)"
    )
    simulate.add_argument("--frames", type=positive_int, default=160, metavar="N", help="(default: 160)")
    simulate.add_argument(
        "--seed", type=int, default=0, metavar="N", help="another world and flight (default: 0)"
    )
    simulate.add_argument(
        "--world",
        choices=tuple(KINDS),
        default="arena",
        help="; ".join(f"{name}: {what}" for name, what in KINDS.items()) + " (default: arena)",
    )
    for action in actions.choices.values():
        add_console(action)


def run(arguments: argparse.Namespace) -> dict[str, Any]:
    """List, fetch or simulate."""
    return _ACTIONS[arguments.action](arguments)


def _list(_: argparse.Namespace) -> dict[str, Any]:
    from horizon_dl.download.public_sets import list_sets

    for entry in list_sets():
        size = f", {entry.megabytes} MB" if entry.megabytes else ""
        print(f"{entry.name}\n    {entry.what}{size}\n    {entry.licence}; {entry.page}")
    told = ("name", "what", "licence", "page", "megabytes")
    return {"sets": [{key: getattr(entry, key) for key in told} for entry in list_sets()]}


def _fetch(arguments: argparse.Namespace) -> dict[str, Any]:
    from horizon_dl.download.fetch import fetch

    folder = fetch(arguments.name, arguments.out or Path(arguments.name))
    print(f"wrote {folder}; {next_command('check-data', folder)}")
    return {"out": folder}


def _simulate(arguments: argparse.Namespace) -> dict[str, Any]:
    from horizon_dl.simulation.simulate import simulate

    out, frames = arguments.out, arguments.frames
    simulate(out, frames=frames, seed=arguments.seed, world=arguments.world, progress=True)
    print(f"wrote {frames} frames to {out}; {next_command('check-data', out)}")
    return {"out": out, "frames": frames, "world": arguments.world}


_ACTIONS = {"list": _list, "fetch": _fetch, "simulate": _simulate}

"""The README's figures from scratch: all sets, all methods, three seeds; ablations, two; what dropout buys.

    HORIZON_DL_DATA=DIR python benchmarks/figures.py --out figures

Takes some two hours on 2 cores (`--only methods`: 40 minutes), one process with one thread on each. Writes
figures.md and figures.json with seeds, versions and machine. DIR holds data sets, one a folder; the embedded
set is added.
"""

import argparse
import multiprocessing
import os
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from pathlib import Path
from typing import Any, NamedTuple

from ablations import ABLATIONS, ablation_figures, ablation_markdown
from dropout_table import dropout_figures, dropout_markdown
from methods import (
    methods_figures,
    methods_markdown,
    ranging_markdown,
    second_truth_markdown,
    threshold_markdown,
)
from nets import all_sets, set_names
from novelty import novelty_figures, novelty_markdown
from shade import shade_figures, shade_markdown

from horizon_dl.output import output_folder, write_json, write_text
from horizon_dl.provenance import machine, versions

PARTS = ("methods", "ablations", "dropout", "novelty", "shade")
SHADED_SET = "kitti"
ABLATION_SEEDS = 2
"""At most; a third would take the whole over an hour."""


class Job(NamedTuple):
    """A piece of work for one process; its result goes to `found[part][key 1][key 2] ...`."""

    part: str
    keys: tuple[str, ...]
    function: Callable[..., Any]
    arguments: tuple[Any, ...]


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--out", type=Path, default=Path("figures"))
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--only", choices=PARTS, help="one part")
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--sets", nargs="+", choices=all_sets(), default=all_sets())
    arguments = parser.parse_args()
    parts = (arguments.only,) if arguments.only else PARTS
    start = time.perf_counter()
    with tempfile.TemporaryDirectory() as nets:
        jobs = list(jobs_of(parts, arguments.sets, range(arguments.seeds), Path(nets)))
        if not jobs:
            parser.error("this part has nothing to do on these sets")
        found = results(jobs, arguments.processes)
    if "methods" in found:  # each of its jobs gives two blocks
        by_set = found["methods"]
        found |= {
            block: {name: one[block] for name, one in by_set.items()} for block in ("methods", "ranging")
        }
    found |= {"seeds": list(range(arguments.seeds)), "versions": versions(), "machine": machine()}
    found["seconds"] = round(time.perf_counter() - start)
    with output_folder(arguments.out, "figures", overwrite=True) as out:
        write_json(out / "figures.json", found)
        write_text(out / "figures.md", as_markdown(found))
    print(as_markdown(found))


def jobs_of(parts: Sequence[str], sets: Sequence[str], seeds: range, nets: Path) -> Iterator[Job]:
    """All jobs, those of one set together: a process keeps the views of the set it had last.

    Novelty is last: it takes the nets that the dropout table has trained. Both want one seed only.
    """
    for name in sets:
        if "methods" in parts:
            yield Job("methods", (name,), methods_figures, (name, seeds))
        if name not in set_names():
            continue  # only the table of all methods has the further sets
        if "dropout" in parts:
            yield Job("dropout", (name,), dropout_figures, (name, seeds[:1], nets))
        if "ablations" in parts:
            for ablation in ABLATIONS:
                few = seeds[:ABLATION_SEEDS]
                yield Job("ablations", (ablation, name), ablation_figures, (name, ablation, few, nets))
        if "shade" in parts and name == SHADED_SET:
            yield Job("shade", (name,), shade_figures, (name, seeds, nets))
    if "novelty" in parts:
        for name in (one for one in sets if one in set_names()):
            yield Job("novelty", (name,), novelty_figures, (name, seeds[:1], nets))


def results(jobs: Sequence[Job], processes: int) -> dict[str, Any]:
    """Do all jobs, `processes` at a time with one thread each."""
    os.environ["OMP_NUM_THREADS"] = "1"  # read by the processes when they import torch
    found: dict[str, Any] = {}
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(processes, mp_context=context) as pool:
        waiting: dict[Future[Any], Job] = {pool.submit(job.function, *job.arguments): job for job in jobs}
        for number, done in enumerate(as_completed(waiting), 1):
            job = waiting[done]
            place = found.setdefault(job.part, {})
            for key in job.keys[:-1]:
                place = place.setdefault(key, {})
            place[job.keys[-1]] = done.result()
            print(f"{number} of {len(jobs)}: {job.part} {' '.join(job.keys)}", file=sys.stderr)
    return {job.part: _in_order(found, jobs, job.part) for job in jobs}


def _in_order(found: dict[str, Any], jobs: Sequence[Job], part: str) -> dict[str, Any]:
    """A part's results in the order of its jobs, not in that of their ends."""
    ordered: dict[str, Any] = {}
    for job in jobs:
        if job.part == part:
            place, source = ordered, found[part]
            for key in job.keys[:-1]:
                place, source = place.setdefault(key, {}), source[key]
            place[job.keys[-1]] = source[job.keys[-1]]
    return ordered


def as_markdown(found: dict[str, Any]) -> str:
    """All tables that there are figures for."""
    blocks = []
    if "methods" in found:
        blocks += [methods_markdown(found["methods"]), second_truth_markdown(found["methods"])]
        blocks += [threshold_markdown(found["methods"]), ranging_markdown(found["ranging"])]
    if "ablations" in found:
        blocks.append(ablation_markdown(found["ablations"], found.get("methods")))
    for part, markdown in (
        ("dropout", dropout_markdown),
        ("novelty", novelty_markdown),
        ("shade", shade_markdown),
    ):
        if part in found:
            blocks.append(f"## {part.capitalize()}\n\n{markdown(found[part])}")
    made = f"Seeds {found['seeds']}; {', '.join(map(str, found['machine'].values()))}; {found['seconds']} s."
    return "\n\n".join([*blocks, made]) + "\n"


if __name__ == "__main__":
    main()

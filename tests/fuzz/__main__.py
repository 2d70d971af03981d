"""Many damaged inputs: `PYTHONPATH=tests python -m fuzz --count 100000 --seed 0`, or `-m tests.fuzz`."""

import argparse
import json
import math
import sys
import tempfile
import time
from functools import partial
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent.parent))

from fuzz.run import run_cases


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=10_000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--only", action="append", metavar="TARGET", help="repeatable")
    parser.add_argument("--seconds", type=float, default=math.inf, help="end after this time")
    arguments = parser.parse_args()
    start = time.perf_counter()
    tell = partial(print, file=sys.stderr, flush=True)
    with tempfile.TemporaryDirectory() as place:
        found = run_cases(
            Path(place), arguments.count, arguments.seed, arguments.only, arguments.seconds, tell
        )
    for title, value in found.summary().items():
        lines = value.items() if isinstance(value, dict) else [("", value)]
        print(title, *(f"  {name}: {json.dumps(one)}" for name, one in lines), sep="\n")
    print(
        f"{found.count} inputs, seed {arguments.seed}, {time.perf_counter() - start:.0f} s: "
        f"{len(found.faults)} faults"
    )
    return 1 if found.faults else 0


if __name__ == "__main__":
    sys.exit(main())

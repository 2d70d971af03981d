"""Many damaged inputs: `PYTHONPATH=tests python -m fuzz --count 100000 --seed 0`, or `-m tests.fuzz`."""

import argparse
import json
import math
import sys
import tempfile
import time
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
    with tempfile.TemporaryDirectory() as place:
        found = run_cases(Path(place), arguments.count, arguments.seed, arguments.only, arguments.seconds)
    print(json.dumps(found.summary(), indent=1))
    for fault in found.faults[:50]:
        print(fault)
    print(
        f"{found.count} inputs, seed {arguments.seed}, {time.perf_counter() - start:.0f} s: "
        f"{len(found.faults)} faults"
    )
    return 1 if found.faults else 0


if __name__ == "__main__":
    sys.exit(main())

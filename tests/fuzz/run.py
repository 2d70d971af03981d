"""Runs cases in process, each with a budget of time and memory."""

import math
import random
import resource
import signal
import time
import traceback
import warnings
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from functools import cache, partial
from pathlib import Path
from typing import Any
from unittest.mock import patch

from fuzz.targets import targets
from horizon_dl.errors import HorizonError
from horizon_dl.readers import registry

MOST_S = 2.0
"""Processor time of one case."""
HANGS_S = 60
"""Wall-clock time after which a case is ended: it waits for something. A busy machine is slow, too."""
MOST_MB = 300
TOLD_EVERY = 5000


@dataclass
class Found:
    """What became of all cases."""

    count: int = 0
    refused: Counter[str] = field(default_factory=Counter)
    read: Counter[str] = field(default_factory=Counter)
    slowest_s: dict[str, float] = field(default_factory=dict)
    took_s: Counter[str] = field(default_factory=Counter)
    grown_mb: float = 0.0
    faults: list[str] = field(default_factory=list)
    tell: Callable[[str], object] = str

    def fault(self, text: str) -> None:
        """Keep it, and tell it now: a long run is looked at while it goes on."""
        self.faults.append(text)
        self.tell(text)

    def summary(self) -> dict[str, Any]:
        names = sorted({*self.refused, *self.read})
        mean_s = {name: self.took_s[name] / (self.read[name] + self.refused[name]) for name in names}
        by_target = {
            name: [
                self.read[name],
                self.refused[name],
                round(1e3 * mean_s[name], 1),
                round(self.slowest_s[name], 2),
            ]
            for name in names
        }
        return {"read, refused, mean ms, slowest s": by_target, "most memory grown, MB": round(self.grown_mb)}


class Hangs(BaseException):
    """A case takes too long."""


def run_cases(
    place: Path,
    count: int,
    seed: int,
    only: list[str] | None = None,
    most_s: float = math.inf,
    tell: Callable[[str], object] = str,
) -> Found:
    """`count` cases, or as many as there is time for, or until Ctrl-C; the same seed gives the same ones."""
    found, chance = Found(tell=tell), random.Random(seed)
    every = [target for target in targets(place) if not only or target.name in only]
    cases = {target.name: target.prepare() for target in every}
    shares = [target.share for target in every]
    readers = patch(f"{registry.__name__}.plugins", cache(registry.plugins))  # a look at all packages is slow
    with suppress(KeyboardInterrupt), warnings.catch_warnings(), readers:
        warnings.filterwarnings("error", category=RuntimeWarning, module="horizon_dl")
        warnings.filterwarnings("ignore", category=RuntimeWarning, module="numpy")
        end = time.monotonic() + most_s
        for number in range(count):
            if time.monotonic() > end:
                break
            if number and number % TOLD_EVERY == 0:
                tell(f"{number} of {count} inputs, {len(found.faults)} faults")
            target = chance.choices(every, shares)[0]
            own = random.Random(f"{seed} {number}")
            _one(found, target.name, number, partial(cases[target.name], own))
    return found


def _one(found: Found, name: str, number: int, case: Any) -> None:
    found.count += 1
    before_mb, start = _forget_peak_mb(), time.process_time()
    try:
        with _alarm():
            case()
        found.read[name] += 1
    except HorizonError as error:
        found.refused[name] += 1
        text = str(error)
        if not text.isprintable() or len(text) > 2500:
            found.fault(f"{name} {number}: a message that is not printable or too long: {text[:200]!r}")
    except (Exception, Hangs) as error:
        where = traceback.extract_tb(error.__traceback__)
        ours = next((line for line in reversed(where) if "horizon_dl" in line.filename), where[-1])
        place = f"{Path(ours.filename).name}:{ours.lineno}"
        found.fault(f"{name} {number}: {type(error).__name__} at {place}: {str(error)[:150]!r}")
    took_s, grown = time.process_time() - start, _peak_mb() - before_mb
    found.took_s[name] += took_s
    found.slowest_s[name] = max(found.slowest_s.get(name, 0.0), took_s)
    found.grown_mb = max(found.grown_mb, grown)
    if took_s > MOST_S or grown > MOST_MB:
        found.fault(f"{name} {number}: {took_s:.1f} s, {grown:.0f} MB")


def _peak_mb() -> float:
    """Most memory held since the peak was last forgotten; where that cannot be, since the start."""
    try:
        status = Path("/proc/self/status").read_text()
        return int(status.split("VmHWM:")[1].split()[0]) / 1024
    except (OSError, LookupError):
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def _forget_peak_mb() -> float:
    """What is held now, from which the next case's peak counts."""
    with suppress(OSError):
        Path("/proc/self/clear_refs").write_text("5")
    return _peak_mb()


@contextmanager
def _alarm() -> Iterator[None]:
    def ring(*_: object) -> None:
        raise Hangs(f"over {HANGS_S} s")

    before = signal.signal(signal.SIGALRM, ring)
    signal.setitimer(signal.ITIMER_REAL, HANGS_S)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)

"""Where independent work is done: in this process, in some beside it, or by the workers of a Dask cluster."""

import multiprocessing
import os
import signal
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Executor, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import ExitStack, contextmanager
from itertools import islice
from threading import Thread
from typing import Any, Protocol, TypeVar

from horizon_dl.errors import InputError

Shared = TypeVar("Shared")
Item = TypeVar("Item")
Result = TypeVar("Result")

AHEAD = 2
"""Items a worker's thread is given ahead; results are taken in order, so memory stays bounded."""
CONNECT_S = 10
LOOPBACK = "127.0.0.1:0"
FOREST_THREADS = "LOKY_MAX_CPU_COUNT"
"""Where scikit-learn, by joblib, reads how many cores there are."""


class Workers(Protocol):
    """Something that applies a function to many items."""

    def map(
        self, function: Callable[[Shared, Item], Result], shared: Shared, items: Iterable[Item]
    ) -> Iterator[Result]:
        """`function(shared, item)` of every item, in the items' order."""
        ...


class SerialWorkers:
    """This process, one item after the other."""

    def map(
        self, function: Callable[[Shared, Item], Result], shared: Shared, items: Iterable[Item]
    ) -> Iterator[Result]:
        """See `Workers.map`."""
        return (function(shared, item) for item in items)


SERIAL = SerialWorkers()


class DaskWorkers:
    """The workers of a Dask cluster; they need this package, and the data under the same path."""

    def __init__(self, client: Any) -> None:
        self._client = client

    def map(
        self, function: Callable[[Shared, Item], Result], shared: Shared, items: Iterable[Item]
    ) -> Iterator[Result]:
        """See `Workers.map`."""
        # In a list, since of a bare tuple each part would be sent on its own.
        (everywhere,) = self._client.scatter([shared], broadcast=True)
        rest = iter(items)
        waiting = [self._submit(function, everywhere, item) for item in islice(rest, self._most())]
        while waiting:
            result: Result = waiting.pop(0).result()
            waiting += [self._submit(function, everywhere, item) for item in islice(rest, 1)]
            yield result

    def _submit(self, function: Callable[..., Any], everywhere: Any, item: Any) -> Any:
        return self._client.submit(function, everywhere, item, pure=False)

    def _most(self) -> int:
        threads = sum(self._client.nthreads().values())
        return AHEAD * max(1, int(threads))


@contextmanager
def open_workers(scheduler: str | None) -> Iterator[Workers]:
    """The workers of a Dask scheduler, `local` for processes of this machine, None for this process.

    Args:
        scheduler: as `tcp://10.0.0.5:8786`, `local`, or None.

    Raises:
        InputError: nothing answers at that address, or no worker has joined.
    """
    if scheduler is None:
        yield SERIAL
        return
    from distributed import Client

    try:
        if scheduler == "local":  # nobody but this machine may ask its scheduler, or look at it
            client = Client(dashboard_address=LOOPBACK, host="127.0.0.1", timeout=CONNECT_S)
        else:
            client = Client(address=scheduler, timeout=CONNECT_S)
    except (OSError, ValueError) as error:
        reason = str(error).partition("\n")[0] or type(error).__name__
        raise InputError(
            f"--scheduler {scheduler}", f"does not answer ({reason})", "start `dask scheduler` there"
        ) from None
    with client:
        if not client.nthreads():
            raise InputError(f"--scheduler {scheduler}", "has no workers", f"start `dask worker {scheduler}`")
        yield DaskWorkers(client)


@contextmanager
def processes_beside(jobs: int) -> Iterator[list[Executor]]:
    """`jobs - 1` processes beside this one, each an executor of its own; the cores are divided among all.

    They end with the block, also where it ends with an error, and with this process, however that ends.

    Raises:
        InputError: one of them was killed.
    """
    if jobs == 1:
        yield []
        return
    import torch

    before, others = torch.get_num_threads(), set(multiprocessing.active_children())
    each = max(1, before // jobs)
    limit = os.environ.get(FOREST_THREADS)
    _divide(each)
    fresh = multiprocessing.get_context("spawn")  # a fork would share the locks of torch's threads
    with ExitStack() as stack:
        # One executor of many processes does not notice the death of one that it started late (Python 3.11).
        beside: list[Executor] = [
            stack.enter_context(
                ProcessPoolExecutor(1, mp_context=fresh, initializer=_begin, initargs=(each,))
            )
            for _ in range(jobs - 1)
        ]
        try:
            yield beside
        except BaseException as error:
            for child in set(multiprocessing.active_children()) - others:
                child.terminate()
            if isinstance(error, BrokenProcessPool):
                problem = "one of the processes was killed, perhaps for want of memory"
                raise InputError(f"--jobs {jobs}", problem, "give fewer jobs") from None
            raise
        finally:
            torch.set_num_threads(before)
            os.environ.pop(FOREST_THREADS)
            if limit is not None:
                os.environ[FOREST_THREADS] = limit


def _divide(threads: int) -> None:
    import torch

    torch.set_num_threads(threads)
    os.environ[FOREST_THREADS] = str(threads)


def _begin(threads: int) -> None:
    _divide(threads)
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the first process hears it, and ends the others
    Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)

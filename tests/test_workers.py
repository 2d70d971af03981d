"""The same work in this process and on a cluster of two workers."""

import json
import multiprocessing
import os
import signal
import time

import pytest
import torch
from distributed import LocalCluster
from toy import write_toy_set

from horizon_dl.cli import main
from horizon_dl.errors import FrameError, InputError
from horizon_dl.evaluation.deal import dealt
from horizon_dl.workers import SERIAL, DaskWorkers, open_workers, processes_beside

QUICK = ["--train.rounds", "[8,4]", "--train.batch", "4", "--train.crop", "32", "--seeds", "1"]
QUICK += ["--forest.training_pixels", "4000"]
TIMES = {"train_s", "predict_ms_per_frame"}


@pytest.fixture(scope="module")
def cluster():
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as started:
        yield started


def without_times(value):
    if isinstance(value, dict):
        return {key: without_times(part) for key, part in value.items() if key not in TIMES}
    return value


def scaled(factor: int, value: int) -> int | FrameError:
    return FrameError("frame", f"number {value} is bad", "mend it") if value == 3 else factor * value


def test_results_come_in_order_and_errors_travel(cluster):
    with open_workers(cluster.scheduler_address) as workers:
        assert isinstance(workers, DaskWorkers)
        found = list(workers.map(scaled, 10, range(40)))
    expected = list(SERIAL.map(scaled, 10, range(40)))
    assert str(found.pop(3)) == str(expected.pop(3)) == "frame: number 3 is bad; mend it"
    assert found == expected == [10 * value for value in range(40) if value != 3]


@pytest.mark.slow
def test_a_cluster_gives_the_same_figures_to_the_last_digit(cluster, tmp_path):
    data = write_toy_set(tmp_path / "toy")
    (data / "images" / "010.png").write_bytes(b"no picture")
    arguments = ["compare", str(data), *QUICK]
    assert main([*arguments, "--out", str(tmp_path / "here")]) == 0
    assert main([*arguments, "--out", str(tmp_path / "there"), "--scheduler", cluster.scheduler_address]) == 0
    here, there = (json.loads((tmp_path / name / "metrics.json").read_text()) for name in ("here", "there"))
    assert here["frames"]["skipped"] == 1
    assert without_times(here) == without_times(there)
    assert here["methods"]["rf"]["scores"]["entropy"]["auc"] is not None


@pytest.mark.slow
@pytest.mark.long
@pytest.mark.parametrize("protocol", ["labelled-out", "prequential"])
def test_seeds_in_processes_beside_give_the_same_figures(tmp_path, protocol):
    data = write_toy_set(tmp_path / "toy")
    seeds = "3" if protocol == "labelled-out" else "2"
    arguments = ["compare", str(data), *QUICK, "--seeds", seeds, "--protocol", protocol]
    torch.set_num_threads(1)  # as the processes have; sums differ by threads in their last digit
    assert main([*arguments, "--out", str(tmp_path / "one")]) == 0
    assert main([*arguments, "--out", str(tmp_path / "two"), "--jobs", "2"]) == 0
    one, two = (json.loads((tmp_path / name / "metrics.json").read_text()) for name in ("one", "two"))
    assert one["methods"]["cnn"]["scores"]["entropy"]["auc_sd"] > 0
    assert without_times(one) == without_times(two)
    assert not left_over()


def left_over() -> list[str]:
    """Children of this process, but those of the cluster beside."""
    names = [child.name for child in multiprocessing.active_children()]
    return [name for name in names if not name.startswith("Dask")]


def kill_itself() -> None:
    os.kill(os.getpid(), signal.SIGKILL)


@pytest.mark.parametrize("victim", [0, 1])
def test_a_process_that_is_killed_is_one_line_and_none_is_left(victim):
    with pytest.raises(InputError, match=r"--jobs 3.*killed"), processes_beside(3) as beside:  # noqa: PT012
        beside[1 - victim].submit(time.sleep, 600)
        beside[victim].submit(kill_itself).result(timeout=300)
    assert not left_over()


def threads_of_a_forest() -> tuple[int, int]:
    import joblib

    return joblib.cpu_count(), torch.get_num_threads()


def test_the_cores_are_divided_and_given_back(monkeypatch):
    monkeypatch.setenv("LOKY_MAX_CPU_COUNT", "7")
    before = torch.get_num_threads()
    torch.set_num_threads(4)
    try:
        with processes_beside(2) as (beside,):
            assert beside.submit(threads_of_a_forest).result(timeout=300) == (min(2, os.cpu_count() or 1), 2)
            assert torch.get_num_threads() == 2
        assert (os.environ["LOKY_MAX_CPU_COUNT"], torch.get_num_threads()) == ("7", 4)
    finally:
        torch.set_num_threads(before)


@pytest.mark.parametrize("processes", [1, 2, 3, 8])
@pytest.mark.parametrize("seeds", [1, 3, 5])
def test_every_learner_and_seed_is_dealt_once(processes, seeds):
    shares = dealt(list(range(seeds)), processes)
    assert len(shares) == processes
    parts = sorted(part for share in shares for part in share)
    assert parts == sorted((name, seed) for name in ("cnn", "rf") for seed in range(1, seeds))


def test_an_error_of_this_process_ends_those_beside_it():
    start = time.monotonic()
    with pytest.raises(KeyboardInterrupt), processes_beside(2) as (beside,):  # noqa: PT012
        beside.submit(time.sleep, 600)
        raise KeyboardInterrupt
    assert time.monotonic() - start < 300
    assert not left_over()


def test_one_job_needs_no_process():
    with processes_beside(1) as beside:
        assert beside == []


def test_an_address_where_nothing_answers_is_named():
    with pytest.raises(InputError, match="does not answer"), open_workers("tcp://127.0.0.1:9"):
        pass


def test_an_address_that_is_none_is_named():
    with pytest.raises(InputError, match="--scheduler"), open_workers("nonsense://x"):
        pass


@pytest.mark.slow
def test_processes_of_this_machine_listen_to_nobody_else():
    psutil = pytest.importorskip("psutil")
    with open_workers("local") as workers:
        assert isinstance(workers, DaskWorkers)
        assert list(workers.map(scaled, 2, [1, 2])) == [2, 4]
        own = psutil.Process()
        places = {
            connection.laddr.ip
            for process in (own, *own.children(recursive=True))
            for connection in process.net_connections()
            if connection.status == psutil.CONN_LISTEN
        }
    assert places <= {"127.0.0.1", "::1"}
    assert places

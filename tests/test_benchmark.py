"""The benchmark of model files."""

import json

import pytest
from small_run import model_file, small_export

from horizon_dl.cli import main
from horizon_dl.runtime.benchmark import STAGES, quartiles, stage_of, timed_in_turn


def test_the_command_reports_times_stages_and_machine(tmp_path, capsys):
    out = tmp_path / "times.json"
    assert main(["benchmark", str(model_file()), str(model_file()), "--runs", "7", "--out", str(out)]) == 0
    figures = json.loads(out.read_text())
    assert figures["machine"]["processor"]
    assert figures["versions"]["onnxruntime"]
    assert figures["runs"] == 7
    assert len(figures["models"]) == 2
    one = figures["models"][0]
    assert (one["image_size"], one["bytes"]) == ([96, 72], model_file().stat().st_size)
    assert len(one["sha256"]) == 64
    assert one["weights_sha256"] == small_export().card["weights_sha256"]
    assert one["cold_start_s"] > 0
    assert set(one["threads"]) == {"1", "2"}
    for found in one["threads"].values():
        assert 0 < found["q1_ms"] <= found["median_ms"] <= found["q3_ms"]
        assert set(found["stages_ms"]) == {*STAGES, "other"}
        assert all(found["stages_ms"][stage] > 0 for stage in STAGES)
        assert found["stages_ms"]["other"] < 0.2 * sum(found["stages_ms"].values())
    printed = capsys.readouterr().out
    assert "96x72" in printed
    assert "quartiles" in printed


def test_threads_are_chosen(capsys):
    assert main(["benchmark", str(model_file()), "--runs", "2", "--threads", "1"]) == 0
    assert len(capsys.readouterr().out.splitlines()) == 3


def test_a_place_that_cannot_be_written_is_named(tmp_path, capsys):
    assert main(["benchmark", str(model_file()), "--out", str(tmp_path / "no" / "times.json")]) == 2
    assert "cannot be written" in capsys.readouterr().err


def test_jobs_take_turns_in_fives():
    calls = []
    times = timed_in_turn({"a": lambda: calls.append("a"), "b": lambda: calls.append("b")}, 7)
    assert {name: len(found) for name, found in times.items()} == {"a": 7, "b": 7}
    assert "".join(calls[10:]) == "aaaaabbbbbaabb"


def test_quartiles():
    assert quartiles([4.0, 1.0, 3.0, 2.0, 5.0]) == {"median_ms": 3.0, "q1_ms": 2.0, "q3_ms": 4.0}


@pytest.mark.parametrize(
    ("node", "stage"),
    [
        ("/encode/encoder/encoder.0/Conv_kernel_time", "encode"),
        ("/uncertainty/Sigmoid_kernel_time", "uncertainty"),
        ("ReorderInput_token_4_kernel_time", "encode"),
        ("Squeeze_token_4_kernel_time", "other"),
    ],
)
def test_nodes_belong_to_stages(node, stage):
    assert stage_of(node) == stage

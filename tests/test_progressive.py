"""Progressive validation: `compare --protocol prequential` and `online` count the same."""

import json
from pathlib import Path

import pytest
from tiny_online import tiny_config, tiny_run

from horizon_dl.evaluation.compare import compare
from horizon_dl.readers.registry import open_recording
from horizon_dl.simulation.embedded import embedded_set


def test_compare_and_online_give_the_same_figures(tmp_path: Path) -> None:
    recording = open_recording(embedded_set())
    few = recording.select(range(26))
    config = tiny_config("forest.trees=2", "forest.training_pixels=2000")
    compared = compare(few, config, "prequential", [config.seed]).metrics["methods"]["cnn"]
    run = tiny_run(embedded_set(), tmp_path / "run", max_frames=26)
    run.run()
    run.finish()
    online = json.loads((tmp_path / "run" / "metrics.json").read_text())["methods"]["cnn"]
    assert online["operating_point"] == pytest.approx(compared["operating_point"])
    assert online["horizon_accuracy"] == pytest.approx(compared["horizon_accuracy"])
    for name, figures in compared["scores"].items():
        assert online["scores"][name] == pytest.approx(figures), name

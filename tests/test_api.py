"""The names that others import, and that each is loaded only when it is asked for."""

import subprocess
import sys
import types
from pathlib import Path

import pytest

import horizon_dl


def test_every_public_name_is_there() -> None:
    assert set(horizon_dl._PLACES) == set(horizon_dl.__all__)
    for name in horizon_dl.__all__:
        assert getattr(horizon_dl, name) is not None
    assert set(horizon_dl.__all__) <= set(dir(horizon_dl))
    with pytest.raises(AttributeError, match="no attribute 'nonsense'"):
        _ = horizon_dl.nonsense


@pytest.mark.parametrize("before", ["pass", "import horizon_dl.export.entropy"])
def test_a_public_name_can_be_called_where_a_room_has_the_same(before: str) -> None:
    """`export` is a room and a function: whichever comes first."""
    rooms = {path.parent.name for path in Path(horizon_dl.__file__).parent.glob("*/__init__.py")}
    names = ", ".join(sorted(rooms & set(horizon_dl.__all__)))
    code = f"{before}\nfrom horizon_dl import {names}\nassert all(callable(one) for one in [{names}])"
    done = subprocess.run([sys.executable, "-c", code], check=False, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


def test_the_public_export_is_the_one_of_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    from horizon_dl.export import export as module

    monkeypatch.setattr(module, "export_run", lambda *given, **named: (given, named))
    assert horizon_dl.export("run", "camera", frames=()) == (("run", "camera"), {"frames": ()})


def test_nothing_heavy_is_loaded_before_it_is_asked_for() -> None:
    code = (
        "import sys, horizon_dl\n"
        "horizon_dl.Camera, horizon_dl.Frame, horizon_dl.ObstacleModel, horizon_dl.open_source\n"
        "bad = {'torch', 'kornia', 'lightning', 'sklearn', 'pydantic', 'av'} & set(sys.modules)\n"
        "sys.exit(str(bad) if bad else 0)"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_a_missing_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    def missing(name: str) -> types.ModuleType:
        raise ModuleNotFoundError("No module named 'torch'", name="torch")

    monkeypatch.setattr(horizon_dl, "import_module", missing)
    with pytest.raises(ImportError, match=r"OnlineLearner needs torch; pip install 'horizon-dl\[train\]'"):
        _ = horizon_dl.OnlineLearner


def test_the_docs_twenty_lines_run(tmp_path: Path) -> None:
    """A learner in somebody's own loop, and a model on a picture, on the embedded flight."""
    from small_run import small_export
    from tiny_online import tiny_config

    from horizon_dl import FrameSource, ObstacleModel, OnlineLearner, open_source
    from horizon_dl.errors import FrameError
    from horizon_dl.simulation.embedded import embedded_set

    source: FrameSource = open_source(embedded_set())
    learner = OnlineLearner(tiny_config())
    for number, frame in enumerate(source.frames()):
        if number == 3:
            break
        assert not isinstance(frame, FrameError)
        prediction = learner.predict(frame)
        assert prediction.entropy.shape == (36, 48)
        learner.learn(frame)
    path = tmp_path / "model.onnx"
    path.write_bytes(small_export().content())
    model = ObstacleModel.load(path)
    camera = model.camera
    import numpy as np

    found = model.predict(np.zeros((camera.height, camera.width, 3), np.uint8), (0.0, -1.0, 0.0))
    assert found.obstacles.shape == (camera.height, camera.width)

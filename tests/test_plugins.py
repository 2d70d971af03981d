"""Readers of other packages: the worked example of docs/READERS.md, as if it were installed."""

import importlib.metadata
import pickle
import re
import sys
import zipfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from horizon_dl.cli import main
from horizon_dl.data.given import Given
from horizon_dl.errors import FrameError, InputError
from horizon_dl.readers.registry import open_recording

DOCS = Path(__file__).parents[1] / "docs" / "READERS.md"
CAMERA = "model: pinhole\nwidth: 32\nheight: 24\nfx: 30\nfy: 30\ncx: 15.5\ncy: 11.5\n"


def offer(monkeypatch: pytest.MonkeyPatch, **values: str) -> None:
    points = [
        importlib.metadata.EntryPoint(name, value, "horizon_dl.readers") for name, value in values.items()
    ]
    real = importlib.metadata.entry_points

    def entry_points(**wanted: str) -> object:
        return points if wanted == {"group": "horizon_dl.readers"} else real(**wanted)

    monkeypatch.setattr(importlib.metadata, "entry_points", entry_points)


@pytest.fixture
def flight(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """An archive with three pictures, the second of which is damaged; the example is there to be found."""
    code = re.search(r"```python\n(.*?)```", DOCS.read_text(), re.DOTALL)
    assert code
    (tmp_path / "lib").mkdir()
    (tmp_path / "lib" / "flight_zip.py").write_text(code[1])
    monkeypatch.syspath_prepend(tmp_path / "lib")
    offer(monkeypatch, flight_zip="flight_zip", torn="no_such_module_anywhere", empty="string")
    (tmp_path / "camera.yaml").write_text(CAMERA)
    path = tmp_path / "flight.zip"
    with zipfile.ZipFile(path, "w") as archive:
        rows = ["c.png,2.0,0,-10", "a.png,0.0,0,0", "b.png,1.0,90,0"]
        archive.writestr("flight.csv", "\n".join(["picture,time_s,roll_deg,pitch_deg", *rows]))
        for name in ("a.png", "c.png"):
            with archive.open(name, "w") as file:
                Image.new("RGB", (32, 24), (9, 8, 7)).save(file, "PNG")
        archive.writestr("b.png", b"no picture")
    yield path
    sys.modules.pop("flight_zip", None)


def test_a_reader_of_another_package_is_found_and_reads(flight: Path) -> None:
    recording = open_recording(flight, given=Given(camera=flight.parent / "camera.yaml"))
    assert recording.format == "flight_zip"
    assert [header.name for header in recording.headers] == ["a.png", "b.png", "c.png"]
    ups = np.array([header.up_cam for header in recording.headers])
    # Roll right: the world's up is to the left in the picture. Nose down: it leans away from the scene.
    np.testing.assert_allclose(ups, [[0, -1, 0], [-1, 0, 0], [0, -np.cos(0.1745), -0.1736]], atol=1e-3)
    frames = list(pickle.loads(pickle.dumps(recording)).frames())
    assert [isinstance(frame, FrameError) for frame in frames] == [False, True, False]


def test_every_verb_takes_it(flight: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check-data", str(flight), "--camera", str(flight.parent / "camera.yaml")]) == 0
    assert "flight (flight_zip)" in capsys.readouterr().out


def test_its_errors_and_broken_ones_are_said(flight: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="give --camera FILE"):
        open_recording(flight)
    other = tmp_path / "notes.txt"
    other.write_text("nothing")
    with pytest.raises(InputError) as said:
        open_recording(other)
    whole = str(said.value.args)  # as one line its middle is left out
    assert "flight_zip: a zip archive" in whole
    assert "torn is installed, but ModuleNotFoundError" in whole
    assert "empty is installed, but has no NAME" in whole
    with pytest.raises(InputError, match="ModuleNotFoundError"):
        open_recording(other, "torn")


def test_the_package_s_own_names_are_not_taken_over(flight: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (flight.parent / "lib" / "thief.py").write_text(
        "NAME = 'tum'\nNEEDS = ''\ndef recognises(path): return True\ndef read(path, given): return None\n"
    )
    offer(monkeypatch, thief="thief")
    with pytest.raises(InputError, match="is no recording"):
        open_recording(flight)

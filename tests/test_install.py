"""`pip install .` alone, in a fresh environment: what flies."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from small_run import model_file, toy_set

ROOT = Path(__file__).parent.parent
TRAINING = ("torch", "torchvision", "lightning", "kornia", "sklearn", "skimage", "scipy", "pydantic", "onnx")
MAIN = ("-c", "import sys; from horizon_dl.cli import main; sys.exit(main())")
MOST_MEGABYTES = 250


@pytest.fixture(scope="module")
def python(tmp_path_factory, no_network) -> Path:
    """A fresh environment with the package and its own dependencies alone."""
    folder = tmp_path_factory.mktemp("fresh") / "venv"
    uv = shutil.which("uv") or ROOT / ".uv" / "bin" / "uv"
    fresh = folder / "bin" / "python"
    constraints = ["--constraint", str(ROOT / "constraints.txt")]
    if Path(uv).exists():
        commands = [
            [uv, "venv", "--quiet", "--python", sys.executable, folder],
            [uv, "pip", "install", "--quiet", "--python", fresh, *constraints, str(ROOT)],
        ]
    else:
        install = [fresh, "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
        commands = [[sys.executable, "-m", "venv", folder], [*install, *constraints, str(ROOT)]]
    for command in commands:
        done = subprocess.run([str(part) for part in command], capture_output=True, text=True, timeout=600)
        if done.returncode and any(word in done.stderr.lower() for word in ("connect", "dns", "network")):
            no_network(f"the package registry cannot be reached: {done.stderr}")
        assert done.returncode == 0, done.stderr
    return fresh


def call(python: Path, *arguments: object) -> subprocess.CompletedProcess[str]:
    command = [str(python), "-I", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, timeout=300, cwd=python.parent)


@pytest.mark.slow
def test_a_plain_install_flies(python, tmp_path):
    for name in TRAINING:
        assert call(python, "-c", f"import {name}").returncode != 0, f"{name} was installed"
    assert call(python, *MAIN, "--help").returncode == 0
    predicted = call(python, *MAIN, "predict", model_file(), toy_set(), "--out", tmp_path / "out")
    assert predicted.returncode == 0, predicted.stderr
    assert len(list((tmp_path / "out" / "panels").iterdir())) == 24
    timed = call(python, *MAIN, "benchmark", model_file(), "--runs", "3", "--out", tmp_path / "times.json")
    assert timed.returncode == 0, timed.stderr


@pytest.mark.slow
def test_a_verb_that_needs_more_says_so(python, tmp_path):
    done = call(python, *MAIN, "train", toy_set(), "--out", tmp_path / "run")
    assert done.returncode == 2
    assert "horizon-dl[train]" in done.stderr


@pytest.mark.slow
def test_a_plain_install_is_small(python):
    packages = python.parent.parent / "lib"
    megabytes = sum(path.stat().st_size for path in packages.rglob("*") if path.is_file()) / 1e6
    assert megabytes < MOST_MEGABYTES

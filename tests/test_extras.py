"""Whatever library is missing, a verb says which extra brings it."""

import ast
import re
import subprocess
import sys
import tomllib
from importlib.metadata import packages_distributions
from pathlib import Path

import pytest
from small_run import model_file, toy_set

from horizon_dl.cli import EXTRA_OF, main

ROOT = Path(__file__).parent.parent
BROUGHT_BY = {"pydantic_core": "pydantic", "backports": "rosbags"}
"""Libraries that another requirement brings along."""
FLY = ["fly", "MODEL", "--source", "DATA", "--mavlink", "udpout:127.0.0.1:9"]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]


def listed(requirements: list[str]) -> set[str]:
    """Names of distributions as the registry writes them."""
    return {re.split(r"[\[<>=!~; ]", one)[0].lower().replace("_", "-") for one in requirements}


def imported() -> set[str]:
    """Top-level modules that the package imports anywhere, functions included."""
    found = set()
    for path in (ROOT / "horizon_dl").rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Import):
                found |= {alias.name.partition(".")[0] for alias in node.names}
            elif isinstance(node, ast.ImportFrom) and node.module:
                found.add(node.module.partition(".")[0])
    newer_stdlib = {"compression"}  # of Python 3.14
    return found - set(sys.stdlib_module_names) - newer_stdlib - {"horizon_dl"}


def test_every_library_is_in_the_extra_that_is_named_for_it() -> None:
    distributions = packages_distributions()
    plain, extras = listed(PROJECT["dependencies"]), PROJECT["optional-dependencies"]
    for module in sorted(imported()):
        names = {name.lower().replace("_", "-") for name in distributions[module]}
        if module in BROUGHT_BY:
            names = {BROUGHT_BY[module]}
        if not names & plain:
            assert names & listed(extras[EXTRA_OF.get(module, "train")]), module


@pytest.mark.parametrize(
    ("module", "words", "extra"),
    [
        ("distributed", ["evaluate", "MODEL", "DATA", "--out", "OUT", "--scheduler", "local"], "cluster"),
        ("distributed", ["compare", "DATA", "--out", "OUT", "--scheduler", "local"], "cluster"),
        ("torchvision", ["train", "DATA", "--out", "OUT", "--model.kind", "resnet18"], "train"),
        ("lightning", ["train", "DATA", "--out", "OUT"], "train"),
        ("mujoco", ["data", "simulate", "--out", "OUT"], "sim"),
        ("rerun", [*FLY, "--rerun", "connect"], "viz"),
        ("pymavlink", FLY, "drone"),
    ],
)
def test_a_missing_library_is_one_line(
    module: str,
    words: list[str],
    extra: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    for name in [name for name in sys.modules if name == module or name.startswith(f"{module}.")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, module, None)
    places = {"DATA": str(toy_set()), "MODEL": str(model_file()), "OUT": str(tmp_path / "out")}
    assert main([places.get(word, word) for word in words]) == 2
    said = capsys.readouterr().err.strip().splitlines()
    assert f"needs {module}; pip install 'horizon-dl[{extra}]'" in said[-1]


def test_the_default_net_needs_no_torchvision() -> None:
    code = "import sys; import horizon_dl.models.build; sys.exit('torchvision' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], cwd=ROOT).returncode == 0

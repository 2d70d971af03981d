"""The Dockerfiles copy what is there and install extras that exist."""

import re
import tomllib
from pathlib import Path

import pytest

TOP = Path(__file__).parents[1]
EXTRAS = tomllib.loads((TOP / "pyproject.toml").read_text())["project"]["optional-dependencies"]


@pytest.mark.parametrize("name", ["Dockerfile", "Dockerfile.fly"])
def test_what_is_copied_is_there_and_extras_exist(name: str) -> None:
    text = (TOP / name).read_text()
    ignored = set((TOP / ".dockerignore").read_text().split())
    for line in re.findall(r"^COPY (.*)$", text, re.M):
        for source in line.split()[:-1]:
            assert (TOP / source).exists(), source
            assert source not in ignored
    (extras,) = re.findall(r"'\.\[([a-z,]+)\]'", text)
    assert set(extras.split(",")) <= set(EXTRAS)
    assert ("train" in extras) == (name == "Dockerfile")
    assert text.rstrip().endswith('ENTRYPOINT ["horizon-dl"]')

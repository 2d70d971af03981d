"""The notebooks run from top to bottom, and what they show is what is stored in them.

They run in this process, cell by cell: six kernels would load torch six times.
"""

import ast
import base64
import io
import re
from contextlib import redirect_stdout
from pathlib import Path
from typing import Any

import nbformat
import pytest
from PIL import Image

FOLDER = Path(__file__).parent.parent / "notebooks"
NOTEBOOKS = sorted(FOLDER.glob("*.ipynb"))
MOST_BYTES = 300_000

each = pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)


def code_cells(path: Path) -> list[Any]:
    return [cell for cell in nbformat.read(path, as_version=4).cells if cell["cell_type"] == "code"]


def run_cell(source: str, names: dict[str, Any]) -> tuple[str, Any]:
    """What a cell prints, and the value of the expression that it ends with."""
    tree, value, printed = ast.parse(source), None, io.StringIO()
    last = tree.body.pop() if isinstance(tree.body[-1], ast.Expr) else None
    with redirect_stdout(printed):
        exec(compile(tree, "cell", "exec"), names)
        if isinstance(last, ast.Expr):
            value = eval(compile(ast.Expression(last.value), "cell", "eval"), names)
    return printed.getvalue(), value


def words(text: str) -> str:
    """Without figures and the room they take: those may differ from machine to machine."""
    return re.sub(r"[\W\d]+", " ", re.sub(r"/tmp/\w+", "", text)).strip()


def shape_of(outputs: list[Any]) -> tuple[str, tuple[int, int] | str | None]:
    """What is stored of a cell: its words, and the size of its picture."""
    text, picture = "", None
    for one in outputs:
        data = one.get("data", {})
        if one["output_type"] == "stream":
            text += one["text"]
        elif "image/jpeg" in data:
            picture = Image.open(io.BytesIO(base64.b64decode(data["image/jpeg"]))).size
        elif "image/svg+xml" in data:
            picture = "svg"
    return words(text), picture


def test_there_are_six():
    assert len(NOTEBOOKS) == 6


@pytest.mark.slow
@each
def test_it_runs_and_shows_what_is_stored(path):
    names: dict[str, Any] = {"__name__": "__main__"}
    for cell in code_cells(path):
        printed, value = run_cell(cell["source"], names)
        picture = getattr(value, "size", None if value is None else "svg")
        assert (words(printed), picture) == shape_of(cell["outputs"]), cell["source"]


@each
def test_outputs_are_stored_and_small(path):
    assert path.stat().st_size < MOST_BYTES
    cells = code_cells(path)
    assert all(
        cell["outputs"]
        for cell in cells
        if not cell["source"].strip().endswith(")") or "print" in cell["source"]
    )
    assert any("image/jpeg" in one.get("data", {}) for cell in cells for one in cell["outputs"])
    assert not any("image/png" in one.get("data", {}) for cell in cells for one in cell["outputs"])

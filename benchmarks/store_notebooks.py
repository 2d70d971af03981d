"""Run the notebooks in a kernel and store what they show, so that a reader on the web sees pictures.

python benchmarks/store_notebooks.py                    all of them
python benchmarks/store_notebooks.py notebooks/1*.ipynb

Pictures are kept as JPEG alone: a notebook stays under 300 KB.
"""

import sys
from pathlib import Path
from typing import Any

import nbformat
from nbclient import NotebookClient

FOLDER = Path(__file__).parent.parent / "notebooks"


def main() -> None:
    for path in [Path(name) for name in sys.argv[1:]] or sorted(FOLDER.glob("*.ipynb")):
        notebook = nbformat.read(path, as_version=4)
        NotebookClient(notebook, timeout=300, kernel_name="python3", record_timing=False).execute()
        for cell in notebook.cells:
            cell["outputs"] = [kept(one) for one in cell.get("outputs", []) if not _is_chatter(one)]
            if cell["cell_type"] == "markdown":
                del cell["outputs"]
        notebook.metadata["language_info"] = {"name": "python"}
        nbformat.validate(notebook)
        path.write_text(nbformat.writes(notebook, version=4) + "\n")
        print(f"{path}: {path.stat().st_size // 1024} KB")


def kept(output: Any) -> Any:
    """An output with the smallest of its pictures."""
    data = output.get("data", {})
    if "image/jpeg" in data:
        data.pop("image/png", None)
    return output


def _is_chatter(output: Any) -> bool:
    return bool(output.get("name") == "stderr")


if __name__ == "__main__":
    main()

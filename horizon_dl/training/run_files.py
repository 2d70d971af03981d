"""The files of a run folder, told apart from other folders without loading torch."""

from pathlib import Path

from horizon_dl.data.regular_file import check_there
from horizon_dl.errors import InputError

WEIGHTS, CONFIG, INFO = "weights.safetensors", "config.yaml", "run.json"
FILES = (WEIGHTS, CONFIG, INFO)


def check_run_folder(folder: Path) -> None:
    """All files of a run folder are there.

    Raises:
        InputError: one is missing.
    """
    check_there(folder)
    for name in FILES:
        if not (folder / name).is_file():
            raise InputError(folder, f"is no run folder: it lacks {name}", "give what `train --out` wrote")

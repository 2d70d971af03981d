"""Where a data set keeps its camera.yaml."""

from pathlib import Path

NAME = "camera.yaml"


def camera_file(folder: Path) -> Path | None:
    """The set's camera.yaml: in the folder, or beside a flight's folder; None for formats without one."""
    places = (folder / NAME, folder.absolute().parent / NAME)
    return next((path for path in places if path.is_file()), None)

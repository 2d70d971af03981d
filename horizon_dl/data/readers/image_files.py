"""Plain pictures: a folder of images, or one image, with nothing known of camera or attitude."""

from pathlib import Path

from horizon_dl.errors import InputError

SUFFIXES = {".jpg", ".jpeg", ".png", ".bmp", ".tif", ".tiff", ".webp"}


def picture_paths(source: Path) -> list[Path]:
    """The images of a folder by name, or the one image that `source` is; empty where there is none.

    Raises:
        InputError: there is no such file or folder.
    """
    if not source.exists():
        raise InputError(source, "does not exist", "give a data set, a folder of images, or an image")
    paths = [source] if source.is_file() else sorted(source.iterdir())
    return [path for path in paths if path.suffix.lower() in SUFFIXES]

"""The data set that ships inside the package."""

from pathlib import Path

from horizon_dl.errors import InputError

SEED, FRAMES, DEPTH_EVERY, QUALITY = 9, 180, 10, 85  # how `simulate` made it


def embedded_set() -> Path:
    """Folder of the embedded data set: a simulated arena flight in the images + CSV format.

    It holds 180 frames of 320x240 at 6 a second with labels for all, and depth for the frames 5, 15, 25, ...

    Raises:
        InputError: the installation lacks it.
    """
    folder = Path(__file__).with_name("embedded")
    if not (folder / "frames.csv").is_file():
        raise InputError(folder, "the embedded data set is missing", "install horizon-dl again")
    return folder

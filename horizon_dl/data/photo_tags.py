"""What photos tell of themselves: EXIF's time and focal length, and DJI's XMP."""

import datetime
import math
import re
from pathlib import Path

from PIL import Image

from horizon_dl.data.decoding import FORMATS
from horizon_dl.data.regular_file import check_regular
from horizon_dl.data.tables.parsing import decimals
from horizon_dl.errors import InputError

HEAD_BYTES = 1 << 18
XMP = re.compile(rb"<x:xmpmeta.*?</x:xmpmeta>", re.DOTALL)
DJI = re.compile(r"drone-dji:(\w+)(?:=\"([^\"]*)\"|>([^<]*)<)")
EXIF_IFD, TIME, SUBSECONDS, FOCAL_35MM = 0x8769, 36867, 37521, 41989
DIAGONAL_35MM = math.hypot(36.0, 24.0)


def dji_tags(path: Path) -> dict[str, str]:
    """DJI's values by name (GimbalPitchDegree, ...); none where the photo is not a DJI's."""
    try:
        check_regular(path)
        with path.open("rb") as file:
            found = XMP.search(file.read(HEAD_BYTES))
    except (OSError, InputError):
        return {}
    text = found.group().decode("utf-8", "replace") if found else ""
    return {name: one or other for name, one, other in DJI.findall(text)}


def exif_time_s(path: Path) -> float | None:
    """When the photo was taken by its own clock, s since 1970 as if that were UTC; to a second, or finer."""
    tags = _exif(path)
    try:
        taken = datetime.datetime.strptime(str(tags.get(TIME)), "%Y:%m:%d %H:%M:%S")
        fraction = decimals(str(tags.get(SUBSECONDS, "")).strip("\0 "))
    except ValueError:
        return None
    return taken.replace(tzinfo=datetime.UTC).timestamp() + fraction


def focal_px(path: Path, width: int, height: int) -> float | None:
    """Focal length in pixels from its 35 mm equivalent, which is by the diagonal."""
    try:
        focal_mm = float(str(_exif(path).get(FOCAL_35MM, 0)))
    except (TypeError, ValueError):
        return None
    return focal_mm / DIAGONAL_35MM * math.hypot(width, height) if focal_mm > 0 else None


def _exif(path: Path) -> dict[int, object]:
    try:
        check_regular(path)
        with Image.open(path, formats=FORMATS) as image:
            return dict(image.getexif().get_ifd(EXIF_IFD))
    except Exception:  # Pillow raises whatever a damaged block makes it stumble over
        return {}

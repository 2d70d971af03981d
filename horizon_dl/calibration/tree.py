"""A camera file of any syntax as a mapping of names to values."""

import json
import re
from pathlib import Path
from typing import Any

from horizon_dl.calibration.limits import MAX_BYTES
from horizon_dl.calibration.yaml_tree import yaml_tree
from horizon_dl.data.regular_file import check_regular
from horizon_dl.data.tables.text import decoded
from horizon_dl.errors import InputError

COLMAP_LINES = "colmap cameras"
_COLMAP = re.compile(r"\s*\d+\s+([A-Z][A-Z_0-9]+)\s+\d+\s+\d+(\s+[-+.\deE]+)+\s*")


def read_tree(path: Path) -> dict[str, Any]:
    """The fields of a YAML (OpenCV's dialect, too), JSON or XML file, or the lines of COLMAP's cameras.txt.

    Raises:
        InputError: missing, too large, not readable, or without fields.
    """
    text = _text(path)
    begin = text.lstrip()[:1]
    if begin == "<":
        from horizon_dl.calibration.xml_tree import xml_tree

        content: Any = xml_tree(path, text)
    elif begin == "{":
        content = _json(path, text)
    else:
        lines = [line.split() for line in text.splitlines() if line.strip() and not line.startswith("#")]
        if lines and all(_COLMAP.fullmatch(" ".join(line)) for line in lines):
            return {COLMAP_LINES: lines}
        content = yaml_tree(path, text)
    if not isinstance(content, dict) and "narrow_stereo" in text[:1000]:
        hint = "give the ost.yaml that the tool wrote beside it"
        raise InputError(path, "is the ROS calibration tool's ost.txt, which does not name its lens", hint)
    if not isinstance(content, dict):
        raise InputError(path, "holds no fields", "write it as 'name: value' lines")
    try:
        return dict(_named(content))
    except RecursionError:
        raise InputError(path, "is nested too deep", "correct the file") from None


def _named(value: Any) -> Any:
    """A value whose names are text at every depth: YAML's may be numbers, dates, or nothing."""
    if isinstance(value, dict):
        return {str(name)[:200]: _named(inner) for name, inner in value.items()}
    return [_named(inner) for inner in value] if isinstance(value, list) else value


def _text(path: Path) -> str:
    try:
        check_regular(path, MAX_BYTES)
        with path.open("rb") as file:
            content = file.read(MAX_BYTES + 1)
        return decoded(content)
    except FileNotFoundError:
        raise InputError(
            path, "is missing", "add the camera's calibration, see README, data formats"
        ) from None
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(path, f"cannot be read ({type(error).__name__})", "check the file") from None


def _json(path: Path, text: str) -> Any:
    try:
        return json.loads(text)
    except (ValueError, RecursionError) as json_error:
        try:  # YAML's own short form begins with a brace, too
            return yaml_tree(path, text)
        except InputError:
            line = getattr(json_error, "lineno", None)
            place = "" if line is None else f" (line {line})"
            raise InputError(path, f"is not valid JSON{place}", "correct the file") from None

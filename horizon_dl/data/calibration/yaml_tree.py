"""YAML camera files in bounded time and memory."""

import re
from pathlib import Path
from typing import Any

import yaml

from horizon_dl.data.calibration.limits import MAX_ALIASES, MAX_DEPTH, MAX_SCALAR
from horizon_dl.errors import InputError

_Base: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)  # ten times as fast, where there is one


class _Loader(_Base):  # type: ignore[misc]
    """The safe loader, which reads OpenCV's matrices as plain mappings."""


def _opencv_value(loader: Any, suffix: str, node: yaml.Node) -> Any:
    if not isinstance(node, yaml.MappingNode):
        raise yaml.constructor.ConstructorError(None, None, "OpenCV's types are mappings", node.start_mark)
    return loader.construct_mapping(node, deep=True)


_Loader.add_multi_constructor("tag:yaml.org,2002:opencv-", _opencv_value)
_Loader.add_multi_constructor("!opencv-", _opencv_value)


def yaml_tree(path: Path, text: str) -> Any:
    """The first document of a YAML text that holds anything.

    Topic tools print one message after the other, each closed by `---`; OpenCV begins with `%YAML:1.0`.

    Raises:
        InputError: not YAML, or built to cost much.
    """
    text = re.sub(r"\A\s*%YAML[: ]1\.\d[^\n]*\n(?:---[^\S\n]*(?:\n|\Z))?", "", text)
    try:
        _check(path, text)
        loader = _Loader(text)
        try:
            content = None
            while content is None and loader.check_data():
                content = loader.get_data()
            return content
        finally:
            loader.dispose()
    except (yaml.YAMLError, ValueError, OverflowError, RecursionError, TypeError) as error:
        line = getattr(getattr(error, "problem_mark", None), "line", None)
        place = "" if line is None else f" (line {line + 1})"
        raise InputError(path, f"is not valid YAML{place}", "correct the file") from None


def _check(path: Path, text: str) -> None:
    """InputError where the first document repeats itself, nests or stretches as no camera file does."""
    aliases = depth = 0
    for event in yaml.parse(text, Loader=_Loader):
        if isinstance(event, yaml.AliasEvent):
            aliases += 1
        elif isinstance(event, yaml.CollectionStartEvent):
            depth += 1
        elif isinstance(event, yaml.CollectionEndEvent):
            depth -= 1
            if depth == 0:  # the first document ends here, and nothing behind it is read
                break
        elif isinstance(event, yaml.ScalarEvent) and not event.style and len(event.value) > MAX_SCALAR:
            raise InputError(path, "holds a value of thousands of characters", "take the value out")
        if aliases > MAX_ALIASES or depth > MAX_DEPTH:
            what = f"over {MAX_ALIASES} aliases" if aliases > MAX_ALIASES else f"over {MAX_DEPTH} levels"
            raise InputError(path, f"has {what}, as no camera file has", "write its values out, side by side")

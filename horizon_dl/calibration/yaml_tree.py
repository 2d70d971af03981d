"""YAML camera files: OpenCV's dialect, and what topic tools print."""

import re
from pathlib import Path
from typing import Any

import yaml

from horizon_dl.data.safe_yaml import BoundedLoader, parse_yaml
from horizon_dl.errors import InputError

MOST_NAMES = 1000


class _Loader(BoundedLoader):
    """The bounded loader, which reads OpenCV's matrices as mappings, and the first document of several."""

    def get_single_node(self) -> yaml.Node | None:
        """The first document that holds anything: topic tools close each message by `---`."""
        self.get_event()  # type: ignore[no-untyped-call]
        while not self.check_event(yaml.StreamEndEvent):
            node: yaml.Node | None = self.compose_document()
            if node is not None and not (isinstance(node, yaml.ScalarNode) and not node.value):
                return node
        return None

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:
        """A mapping; a name that stands twice has two values, of which none is the right one."""
        names = [key.value for key, _ in node.value if isinstance(key, yaml.ScalarNode)]
        twice = (
            next((name for name in names if names.count(name) > 1), None) if len(names) < MOST_NAMES else None
        )
        if twice is not None:
            raise yaml.constructor.ConstructorError(
                None, None, f"'{twice[:40]}' stands twice", node.start_mark
            )
        return super().construct_mapping(node, deep)


def _opencv_value(loader: yaml.SafeLoader, suffix: str, node: yaml.Node) -> Any:
    if not isinstance(node, yaml.MappingNode):
        raise yaml.constructor.ConstructorError(None, None, "OpenCV's types are mappings", node.start_mark)
    return loader.construct_mapping(node, deep=True)


_Loader.add_multi_constructor("tag:yaml.org,2002:opencv-", _opencv_value)
_Loader.add_multi_constructor("!opencv-", _opencv_value)


def yaml_tree(path: Path, text: str) -> Any:
    """The value of a YAML text.

    Raises:
        InputError: not YAML, or built to cost much.
    """
    text = re.sub(r"\A\s*%YAML[: ]1\.\d[^\n]*\n(?:---[^\S\n]*(?:\n|\Z))?", "", text)
    try:
        return parse_yaml(text, _Loader)
    except ValueError as error:
        raise InputError(path, str(error), "correct the file") from None

"""YAML from strangers, in bounded time and memory: size, nesting, and what aliases would grow to are limited.

The safe loader runs no code, but a file of a few hundred bytes whose aliases stand for ten others each stands
for a billion values: looked at as a whole, even for an error's text, they take all time and memory there is.
"""

from collections.abc import Hashable
from pathlib import Path
from typing import Any

import yaml

from horizon_dl.data.regular_file import read_regular
from horizon_dl.errors import InputError

MOST_BYTES = 256 * 1024
"""A calibration with all its corner points has some ten thousand bytes."""
MOST_VALUES = 12_000
MOST_DEPTH = 40
LONGEST_NUMBER = 400
_NUMBERS = frozenset(f"tag:yaml.org,2002:{kind}" for kind in ("int", "float", "timestamp", "bool"))


class BoundedLoader(yaml.SafeLoader):
    """The safe loader, which refuses what would grow, and mappings whose keys are no values.

    Dialects derive from it and add their constructors.
    """

    _depth = 0
    _composed = 0

    def compose_node(self, parent: yaml.Node | None, index: Any) -> yaml.Node | None:
        """One value, counted while the text is read: reading alone takes long where there are too many."""
        self._depth += 1
        self._composed += 1
        if self._depth > MOST_DEPTH or self._composed > MOST_VALUES:
            many = f"nested deeper than {MOST_DEPTH} levels, or more than {MOST_VALUES} values"
            raise yaml.MarkedYAMLError(problem=many, problem_mark=self.get_mark())
        node: yaml.Node | None = super().compose_node(parent, index)
        self._depth -= 1
        return node

    def get_single_data(self) -> Any:
        """The document's value.

        Raises:
            YAMLError: it is none, or exceeds the limits.
        """
        node = self.get_single_node()
        if node is None:
            return None
        grown_size(node)
        return self.construct_document(node)


def parse_yaml(text: str, loader: type[yaml.SafeLoader] = BoundedLoader) -> Any:
    """The value of a YAML text.

    Args:
        text: of at most `MOST_BYTES`.
        loader: a `BoundedLoader`.

    Raises:
        ValueError: it is not valid, or exceeds the limits; one line says what is wrong, and where.
    """
    if len(text) > MOST_BYTES:
        raise ValueError(f"is larger than {MOST_BYTES // 1024} KB")
    try:
        return yaml.load(text, Loader=loader)
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        place = "" if mark is None else f" (line {mark.line + 1})"
        said = getattr(error, "problem", None) or "it cannot be parsed"
        raise ValueError(f"is not valid YAML{place}: {said[:100]}") from None
    except (RecursionError, ValueError, TypeError, AttributeError, OverflowError, KeyError, IndexError):
        raise ValueError("is not valid YAML: a value cannot be read") from None


def read_yaml(path: Path, loader: type[yaml.SafeLoader] = BoundedLoader) -> Any:
    """The value in a YAML file; see `parse_yaml`.

    Raises:
        FileNotFoundError: there is none.
        InputError: it cannot be read, is not valid, or exceeds the limits.
    """
    text = read_regular(path, MOST_BYTES)
    try:
        return parse_yaml(text, loader)
    except ValueError as error:
        raise InputError(path, str(error), "correct the file") from None


def grown_size(node: yaml.Node) -> int:
    """How many values a document stands for, each alias counted as often as it is used.

    Raises:
        YAMLError: too many, nested too deep, within itself, or with a number of too many digits.
    """
    return _size(node, {}, set())


def _size(node: yaml.Node, known: dict[int, int], open_nodes: set[int]) -> int:
    if id(node) in known:
        return known[id(node)]
    if id(node) in open_nodes:
        raise _refused(node, "a value holds itself")
    if node.tag in _NUMBERS and len(node.value) > LONGEST_NUMBER:
        raise _refused(node, f"a number of more than {LONGEST_NUMBER} digits")
    open_nodes.add(id(node))
    size = 1
    for part in _parts(node):
        size += _size(part, known, open_nodes)
        if size > MOST_VALUES:
            raise _refused(node, f"more than {MOST_VALUES} values, as its aliases grow")
    open_nodes.discard(id(node))
    known[id(node)] = size
    return size


def _parts(node: yaml.Node) -> list[yaml.Node]:
    if isinstance(node, yaml.MappingNode):
        return [part for pair in node.value for part in pair]
    return list(node.value) if isinstance(node, yaml.SequenceNode) else []


def _refused(node: yaml.Node, problem: str) -> yaml.MarkedYAMLError:
    return yaml.MarkedYAMLError(problem=problem, problem_mark=node.start_mark)


def brief(value: Hashable | object, longest: int = 60) -> str:
    """A value for a message: scalars as they are, cut; of others only what they are.

    Example:
        >>> brief("soft"), brief([1, 2]), brief({"a": 1})
        ("'soft'", 'a list of 2', 'a mapping of 1')
    """
    if isinstance(value, dict):
        return f"a mapping of {len(value)}"
    if isinstance(value, list | tuple | set):
        return f"a list of {len(value)}"
    if isinstance(value, int) and not isinstance(value, bool) and value.bit_length() > 200:
        return "a number of many digits"
    text = repr(value[:longest] if isinstance(value, str) else value)
    return text if len(text) <= longest + 2 else f"{text[:longest]}..."

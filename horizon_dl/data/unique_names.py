"""Names of frames, unique within their recording."""

from collections import Counter
from collections.abc import Sequence


def unique_names(names: Sequence[str]) -> list[str]:
    """The names, with a number behind those that were there before.

    Example:
        >>> unique_names(["a.png", "b.png", "a.png"])
        ['a.png', 'b.png', 'a.png#2']
    """
    seen: Counter[str] = Counter()
    taken, result = set(names), []
    for name in names:
        seen[name] += 1
        unique = name if seen[name] == 1 else f"{name}#{seen[name]}"
        while seen[name] > 1 and unique in taken:
            seen[name] += 1
            unique = f"{name}#{seen[name]}"
        taken.add(unique)
        result.append(unique)
    return result

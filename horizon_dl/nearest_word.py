"""Did you mean: the nearest word to one that is not known."""

from collections.abc import Iterable
from difflib import get_close_matches


def meant(word: str, known: Iterable[str]) -> str:
    """` (did you mean NAME?)`, or nothing where no known word is near.

    Example:
        >>> meant("tran", ("train", "predict"))
        ' (did you mean train?)'
    """
    near = get_close_matches(word, list(known), n=1, cutoff=0.6)
    return f" (did you mean {near[0]}?)" if near else ""

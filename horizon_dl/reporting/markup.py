"""HTML as nested calls: every text is escaped, so that no name of a file can become part of the page."""

from html import escape


class Html(str):
    """Text that is HTML already."""

    __slots__ = ()


def el(tag: str, *children: "str | Html | None", **attributes: "str | int | bool | None") -> Html:
    """An element; children that are no `Html` are escaped, and so are attributes.

    `class_` stands for `class`, `_` in a name for `-`; an attribute that is None or False is left out.

    Example:
        >>> el("p", "a < b", class_="lead")
        '<p class="lead">a &lt; b</p>'
    """
    names = []
    for name, value in attributes.items():
        if value is None or value is False:
            continue
        name = name.rstrip("_").replace("_", "-")
        names.append(f" {name}" if value is True else f' {name}="{escape(str(value))}"')
    start = f"<{tag}{''.join(names)}>"
    return Html(start if tag in VOID else f"{start}{join(*children)}</{tag}>")


VOID = ("img", "meta", "br", "input", "link", "source")


def join(*children: "str | Html | None") -> Html:
    """Children side by side."""
    parts = [child if isinstance(child, Html) else escape(child) for child in children if child is not None]
    return Html("".join(parts))

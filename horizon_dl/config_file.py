"""The commented built-in configs: where they lie, and what their comments say of every key."""

from collections.abc import Iterator
from pathlib import Path

from horizon_dl.errors import InputError
from horizon_dl.nearest_word import meant


def config_folder() -> Path:
    """Folder of the built-in configs: inside an installed package, or at the top of a checkout."""
    installed = Path(__file__).parent / "configs"
    return installed if installed.is_dir() else Path(__file__).parent.parent / "configs"


def builtin_configs() -> list[str]:
    """Names of the built-in configs."""
    return sorted(path.stem for path in config_folder().glob("*.yaml"))


def builtin_config(name: str) -> Path:
    """Path of a built-in config; InputError for an unknown name."""
    path = config_folder() / f"{name}.yaml"
    if name not in builtin_configs():
        problem = f"is no built-in config{meant(name, builtin_configs())}"
        raise InputError(name, problem, f"take one of {', '.join(builtin_configs())}")
    return path


def keys_with_meaning() -> Iterator[tuple[str, str, str]]:
    """Dotted key, default and meaning of every value of the default config, in the file's order.

    The meaning is the comment above the key, or above the keys before it that share one.
    """
    section, meaning, fresh = "", "", True
    for line in builtin_config("default").read_text(encoding="utf-8").splitlines():
        text = line.strip()
        if text.startswith("#"):
            meaning = text[1:].strip() if fresh else f"{meaning} {text[1:].strip()}"
            fresh = False
            continue
        name, colon, value = text.partition(":")
        if colon and value.strip():
            yield (f"{section}.{name}" if line.startswith(" ") else name), value.strip(), meaning
        elif colon:
            section, meaning = name, ""
        fresh = True

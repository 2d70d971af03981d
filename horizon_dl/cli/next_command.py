"""The hint at the next command that a verb prints at its end: words that can be typed in a shell."""

import argparse
import shlex


def next_command(*words: object) -> str:
    """The hint.

    Example:
        >>> next_command("evaluate", "my run", "DATA")
        "next: horizon-dl evaluate 'my run' DATA"
    """
    return f"next: horizon-dl {shlex.join(map(str, words))}"


def data_words(arguments: argparse.Namespace) -> list[str]:
    """`DATA` and what was given beside it, see `data_options.add_given`."""
    offset_s, drift_ppm, find = arguments.time_offset
    offset = "auto" if find else f"{offset_s!r},{drift_ppm!r}" if offset_s or drift_ppm else None
    words = [str(arguments.data)]
    for option, value in {
        "--format": arguments.format,
        "--camera": arguments.camera,
        "--imu-axes": arguments.imu_axes,
        "--convention": arguments.convention,
        "--attitude": arguments.attitude,
        "--time-offset": offset,
        "--time-unit": arguments.time_unit,
        "--angle-unit": arguments.angle_unit,
    }.items():
        words += _option(option, value)
    for topic in arguments.topic:
        words += _option("--topic", topic)
    return words


def _option(name: str, value: object) -> list[str]:
    """An option with its value, nothing without one; what begins with a dash would be taken for an option."""
    text = str(value)
    return [] if value is None else [f"{name}={text}"] if text.startswith("-") else [name, text]

"""Seeded damage to bytes and text: what disks do, and what people with bad intentions write."""

import random
from collections.abc import Callable

NUMBERS = (
    *("nan", "inf", "-inf", "1e300", "-1e300", "1e-300", "1e308", "0", "-0.0", "-1", "1e9", "2147483648", ""),
    *(
        "9" * 400,
        "0." + "3" * 400,
        "9" * 5000,
        "1e400",
        "0x10",
        "1_000",
        "٣",
        "²",
        "1,5",
        "true",
        "null",
        "~",
    ),
)
WORDS = (
    *("../../../etc/passwd", "/etc/passwd", "/dev/zero", "a" * 300, "a/" * 600, "\x1b[2J\x1b]0;x\x07", "\0"),
    *(
        "\u202egnp.exe",
        "\ud800",
        "images",
        ".",
        "..",
        "con",
        "-",
        "--",
        "%s%n",
        "{0}",
        "$(ls)",
        "'",
        '"',
        "`",
    ),
    *("[" * 200, "{a: " * 100, "&a [*a]", "*a", "!!python/name:os.system x", "? [1]", "a: b: c", "- " * 100),
)
PIECES = ("\n", "\r", "\t", " ", ",", ":", ";", "#", "\ufeff", "-", ".", "e", "[", "]", "{", "}", '"', "'")


def bomb(chance: random.Random) -> str:
    """YAML whose aliases stand for billions of values."""
    levels = chance.randrange(8, 30)
    lines = ["a0: &a0 x"]
    lines += [f"a{n}: &a{n} [{', '.join([f'*a{n - 1}'] * 10)}]" for n in range(1, levels)]
    return "\n".join([*lines, f"{chance.choice(('fx', 'model', 'train', 'width'))}: *a{levels - 1}"])


def damaged(content: bytes, chance: random.Random) -> bytes:
    """One to four mutations."""
    for _ in range(chance.choice((1, 1, 1, 2, 4))):
        content = chance.choice(KINDS)(content, chance)
    return content


def _flip(content: bytes, chance: random.Random) -> bytes:
    if not content:
        return content
    changed = bytearray(content)
    changed[chance.randrange(len(changed))] ^= 1 << chance.randrange(8)
    return bytes(changed)


def _cut(content: bytes, chance: random.Random) -> bytes:
    return content[: chance.randrange(len(content) + 1)]


def _lose(content: bytes, chance: random.Random) -> bytes:
    at = chance.randrange(len(content) + 1)
    return content[:at] + content[at + chance.randrange(1, 60) :]


def _repeat(content: bytes, chance: random.Random) -> bytes:
    at, length = chance.randrange(len(content) + 1), chance.randrange(1, 80)
    return content[:at] + content[at : at + length] * chance.choice((2, 3, 50)) + content[at + length :]


def _overwrite(content: bytes, chance: random.Random) -> bytes:
    at, length = chance.randrange(len(content) + 1), chance.randrange(1, 9)
    value = chance.choice(
        (b"\0" * length, b"\xff" * length, bytes(chance.randrange(256) for _ in range(length)))
    )
    return content[:at] + value + content[at + length :]


def _number(content: bytes, chance: random.Random) -> bytes:
    """Another number in the place of one."""
    return _exchange(content, chance, b"0123456789.-+e", chance.choice(NUMBERS))


def _word(content: bytes, chance: random.Random) -> bytes:
    letters = b"abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_/."
    return _exchange(content, chance, letters, chance.choice(WORDS))


def _insert(content: bytes, chance: random.Random) -> bytes:
    at = chance.randrange(len(content) + 1)
    text = chance.choice((*PIECES, *WORDS, *NUMBERS))
    return content[:at] + text.encode(errors="surrogatepass") + content[at:]


def _line(content: bytes, chance: random.Random) -> bytes:
    """A line lost, doubled, or moved."""
    lines = content.split(b"\n")
    at = chance.randrange(len(lines))
    line = lines.pop(at)
    if chance.random() < 0.6:
        lines.insert(chance.randrange(len(lines) + 1), line)
    if chance.random() < 0.5:
        lines.insert(chance.randrange(len(lines) + 1), line)
    return b"\n".join(lines)


def _exchange(content: bytes, chance: random.Random, of: bytes, by: str) -> bytes:
    if not content:
        return content
    start = chance.randrange(len(content))
    at = next((place for place in range(start, len(content)) if content[place] in of), None)
    if at is None:
        return content
    end = at
    while end < len(content) and content[end] in of:
        end += 1
    return content[:at] + by.encode(errors="surrogatepass") + content[end:]


KINDS: tuple[Callable[[bytes, random.Random], bytes], ...] = (
    *(_flip, _cut, _lose, _repeat, _overwrite, _insert, _line),
    *(_number, _number, _number, _word, _word),
)

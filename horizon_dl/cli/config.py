"""Show or copy the commented built-in configs.

horizon-dl config show            the default config, with what every value means
horizon-dl config show NAME       another one
horizon-dl config copy NAME       writes NAME.yaml here, to be changed and given to --config
"""

import argparse
from pathlib import Path


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the verb."""
    parser.add_argument("action", choices=("show", "copy"))
    parser.add_argument(
        "name", nargs="?", default="default", metavar="NAME", help="built-in config (default: default)"
    )
    parser.add_argument("--out", type=Path, metavar="FILE", help="where `copy` writes (default: NAME.yaml)")


def run(arguments: argparse.Namespace) -> None:
    """Print the file, or write a copy of it."""
    from horizon_dl.config_file import builtin_config
    from horizon_dl.errors import InputError

    text = builtin_config(arguments.name).read_text()
    if arguments.action == "show":
        print(text, end="")
        return
    out = arguments.out or Path(f"{arguments.name}.yaml")
    try:
        with out.open("x") as file:
            file.write(text)
    except FileExistsError:
        raise InputError(out, "exists already", "remove it or give another --out") from None
    except OSError as error:
        raise InputError(out, f"cannot be written ({error.strerror})", "give another --out") from None
    print(f"wrote {out}")

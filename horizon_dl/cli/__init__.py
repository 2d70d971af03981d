"""The command line: `horizon-dl VERB ...`, one module a verb.

Verb modules import only light things at their top: `--help` has to answer at once.
"""

import argparse
import os
import signal
import sys
import threading
import traceback
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from importlib import import_module

from horizon_dl import __version__, processes
from horizon_dl.cli.console import add_console, coloured, console, is_verbose, say, write_result
from horizon_dl.cli.places import check_places
from horizon_dl.cli.suggest import SuggestingParser
from horizon_dl.errors import InputError, printable, shortened
from horizon_dl.nearest_word import meant

VERBS = {
    "demo": "the whole story on the embedded data set",
    "data": "public data sets, and simulated worlds",
    "check-data": "whether a data set can work, and why not",
    "calibrate-mount": "the camera's mount error from the images themselves",
    "train": "train the net on a data set",
    "online": "learn from a stream in one pass, resumable",
    "compare": "the net against the forest and training-free baselines",
    "evaluate": "a trained net against truth",
    "predict": "panels and arrays from a trained net",
    "export": "a trained net as one ONNX file",
    "benchmark": "latency of an exported file on this machine",
    "fly": "the onboard loop: obstacle distances for an autopilot",
    "config": "show or copy the commented built-in configs",
    "template": "files to fill in, for data of your own",
    "completion": "completion of verbs and options in a shell",
}
EXTRA_OF = {
    "mujoco": "sim",
    "pymavlink": "drone",
    "serial": "drone",
    "cv2": "drone",
    "av": "logs",
    "rerun": "viz",
    "cyclonedds": "dds",
    "cryptography": "sign",
    "distributed": "cluster",
    "pyulog": "logs",
    "rosbags": "logs",
    "backports": "logs",
}
"""Extra by module, for those that are of another one than `train`."""
OURS = "horizon_dl"
PRINTING = ("config", "template", "completion")
"""Verbs whose results are what they print."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; returns the exit code: 0 done, 1 failed, 2 wrong use or bad input."""
    parsed = parse(sys.argv[1:] if arguments is None else arguments)
    processes.begin(parsed.verb)
    if processes.is_helper():
        _keep_silent()
    with _signals():
        return _run(parsed)


def _run(parsed: argparse.Namespace) -> int:
    """Run the verb; what it returns, figures and places of files, is the object of `--json`."""
    try:
        with console(parsed):
            check_places(parsed)
            result = parsed.run(parsed)
        write_result(parsed, {"exit_code": 0, **(result or {})})
    except InputError as error:
        return _say(parsed, 2, str(error))
    except ModuleNotFoundError as error:
        missing = (error.name or "").partition(".")[0]
        if missing == OURS:
            raise
        extra = EXTRA_OF.get(missing, "train")
        return _say(parsed, 2, f"{parsed.verb}: needs {missing}; pip install 'horizon-dl[{extra}]'")
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1
    except KeyboardInterrupt as error:
        return _say(parsed, 1, str(error) or "stopped; nothing half-written is left")
    except Exception as error:
        if os.environ.get("HORIZON_DL_TRACEBACK") or is_verbose(parsed):
            traceback.print_exc()
        first_line = shortened(str(error).strip().partition("\n")[0])
        line = f"{parsed.verb} failed: {type(error).__name__}: {first_line}; -v shows where"
        return _say(parsed, 1, line)
    return 0


def parse(arguments: Sequence[str]) -> argparse.Namespace:
    """Parse; dotted options (`--train.batch 4`) are collected in `overrides` for verbs with a config."""
    parser = SuggestingParser(
        prog="horizon-dl", description="Obstacles from what lies above and below the horizon."
    )
    parser.add_argument("--version", action="version", version=f"horizon-dl {__version__}")
    plain, overrides = split_overrides(arguments)
    words = os.environ.get("COMP_LINE", "").split() if "_ARGCOMPLETE" in os.environ else plain
    verb = next((word for word in plain if not word.startswith("-")), None)
    if verb is not None and verb not in VERBS:
        parser.error(f"'{printable(verb)}' is no verb{meant(verb, VERBS)}")
    verbs = parser.add_subparsers(dest="verb", metavar="VERB", required=True)
    for verb, summary in VERBS.items():
        child = verbs.add_parser(
            verb, help=summary, formatter_class=argparse.RawDescriptionHelpFormatter, allow_abbrev=False
        )
        if verb in words:  # the others' modules would only be loaded to be forgotten
            module = import_module(f"{OURS}.cli.{verb.replace('-', '_')}")
            child.description = module.__doc__
            module.add_arguments(child)
            if verb not in PRINTING:
                add_console(child)
            if "--help" in plain or "-h" in plain:
                child.epilog = _keys(child)
            child.set_defaults(run=module.run)
    if "_ARGCOMPLETE" in os.environ:
        import argcomplete

        argcomplete.autocomplete(parser)
    parsed = parser.parse_args(plain)
    for override in () if hasattr(parsed, "config") else overrides:
        sections = getattr(parsed, "sections", ())
        if override.partition(".")[0] not in sections:
            taken = f"no config values but those of {', '.join(sections)}" if sections else "no config values"
            parser.error(f"{parsed.verb} takes {taken}: --{override}")
    parsed.overrides = overrides
    return parsed


def _keys(parser: argparse.ArgumentParser) -> str | None:
    """Every dotted key that a verb takes with its meaning, for its help."""
    sections = parser.get_default("sections")
    takes_all = any(action.dest == "config" for action in parser._actions)
    if not (takes_all or sections):
        return None
    from horizon_dl.config_file import keys_with_meaning

    lines = [
        f"  --{key} {value}\n      {meaning}"
        for key, value, meaning in keys_with_meaning()
        if takes_all or key.partition(".")[0] in sections
    ]
    return "\n".join(["values of the config:", *lines])


def split_overrides(arguments: Sequence[str]) -> tuple[list[str], list[str]]:
    """Separate `--a.b value` and `--a.b=value` from the plain arguments.

    Example:
        >>> split_overrides(["train", "DATA", "--train.batch", "10", "--model.dropout=0.1"])
        (['train', 'DATA'], ['train.batch=10', 'model.dropout=0.1'])
    """
    plain: list[str] = []
    overrides: list[str] = []
    rest = iter(arguments)
    for argument in rest:
        name, equals, value = argument.partition("=")
        if name.startswith("--") and "." in name:
            overrides.append(f"{name[2:]}={value if equals else next(rest, '')}")
        else:
            plain.append(argument)
    return plain, overrides


@contextmanager
def _signals() -> Iterator[None]:
    """SIGTERM ends a verb as Ctrl-C does, so that nothing half-written is left; once, not in the midst of it.

    Handlers are put back at the end: libraries exchange them for their own.
    """

    def end(number: int, _: object) -> None:
        signal.signal(number, signal.SIG_IGN)
        raise KeyboardInterrupt

    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    signal.signal(signal.SIGTERM, end)
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, signal.SIG_DFL if handler is None else handler)


def _keep_silent() -> None:
    os.environ["TQDM_DISABLE"] = "1"
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _say(parsed: argparse.Namespace, code: int, line: str) -> int:
    line = printable(line)
    say(f"{coloured('horizon-dl:', 'error', sys.stderr)} {line}")
    write_result(parsed, {"exit_code": code, "error": line})
    return code

"""A parser that names the nearest option where one was mistyped."""

import argparse
from typing import NoReturn

from horizon_dl.nearest_word import meant


class SuggestingParser(argparse.ArgumentParser):
    """A parser whose errors are one or two lines, with the nearest option where one was mistyped."""

    def error(self, message: str) -> NoReturn:
        """Print the message and where help is, and exit with 2."""
        _, unknown, rest = message.partition("unrecognized arguments: ")
        if unknown:
            options = [name for action in self._actions for name in action.option_strings]
            message += meant(rest.split()[0], options)
        self.exit(2, f"{self.prog}: {message}; see {self.prog} --help\n")

"""Completion of verbs, options and values in a shell.

  horizon-dl completion bash >> ~/.bashrc
  horizon-dl completion zsh  >> ~/.zshrc
  horizon-dl completion fish > ~/.config/fish/completions/horizon-dl.fish

What is printed asks horizon-dl itself, so it knows the options of the version that is installed.
"""

import argparse


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the verb."""
    parser.add_argument("shell", choices=("bash", "zsh", "fish"))


def run(arguments: argparse.Namespace) -> None:
    """Print the lines for the shell's start-up file."""
    from argcomplete.shell_integration import shellcode

    print(shellcode(["horizon-dl"], shell=arguments.shell))

"""Verb `kinesic completion`: print the completion script of a shell."""

import click
from click.shell_completion import get_completion_class

from kinesic.body.config import ConfigError
from kinesic.cli.completion import SHELL_NAMES
from kinesic.cli.verbs import kinesic

COMPLETION_VARIABLE = "_KINESIC_COMPLETE"  # environment variable by which a shell asks for completions


def print_script(shell: str) -> int:
    """Print the script that completes kinesic command lines in a shell.

    Raises:
        ConfigError: the shell is unknown.
    """
    kind = get_completion_class(shell)
    if kind is None:
        raise ConfigError(f"no completion for {shell}; there is one for {', '.join(SHELL_NAMES)}")
    click.echo(kind(kinesic, {}, "kinesic", COMPLETION_VARIABLE).source())
    return 0

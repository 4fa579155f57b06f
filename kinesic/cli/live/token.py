"""Read a server's token from an option, file or environment variable."""

import os
import re
from collections.abc import Callable
from functools import wraps
from pathlib import Path

import click

from kinesic.files.private_file import read_secret

TOKEN_VARIABLE = "KINESIC_TOKEN"  # environment variable that holds the token
FILE_HELP = "FILE whose first line is the token; other users must not be able to read it."
SHOWN_WARNING = (
    "warn: --token: other users may have seen the token in the process list; "
    "give --token-file FILE, or set KINESIC_TOKEN"
)
ARGUMENT_START_FIELD = 47  # field of /proc/self/stat, counted from 0: address of the first argument
ARGUMENT_END_FIELD = 48  # field of /proc/self/stat, counted from 0: address after the last argument

Verb = Callable[..., int]


def token_option(help_text: str) -> Callable[[Verb], Verb]:
    """Add --token and --token-file, passed to the verb as `token`.

    Args:
        help_text: help text of --token.
    """

    def decorate(verb: Verb) -> Verb:
        @wraps(verb)
        def begin(*, token: str | None, token_file: Path | None, **given: object) -> int:
            return verb(token=_choose_token(token, token_file), **given)

        from_file = click.option("--token-file", type=click.Path(path_type=Path), metavar="FILE", help=FILE_HELP)
        return click.option("--token", help=help_text)(from_file(begin))

    return decorate


def hide_token() -> None:
    """Overwrite the value of --token in the process list (Linux only)."""
    try:
        fields = Path("/proc/self/stat").read_text(encoding="ascii").rpartition(")")[2].split()
        start, end = (int(fields[number - 2]) for number in (ARGUMENT_START_FIELD, ARGUMENT_END_FIELD))
        with open("/proc/self/mem", "r+b", buffering=0) as memory:
            memory.seek(start)
            arguments = memory.read(end - start)
            memory.seek(start)
            memory.write(_without_token(arguments))
    except (OSError, IndexError, ValueError):
        return  # Linux without access to /proc, or another system; the warning is printed anyway.


def _without_token(arguments: bytes) -> bytes:
    """Replace the token in NUL-terminated arguments without changing their length."""
    return re.sub(rb"(?<=\0--token[\0=])[^\0]+", lambda match: b"x" * len(match[0]), arguments)


def _choose_token(token: str | None, token_file: Path | None) -> str | None:
    """Return the token of the command line, file or environment, or None.

    Raises:
        UsageError: --token and --token-file are both given.
        ConfigError: the file is missing, or others can read it.
    """
    if token is not None:
        hide_token()
        if token_file is not None:
            raise click.UsageError("--token and --token-file: give one of them")
        click.echo(SHOWN_WARNING, err=True)
        return token or None
    if token_file is not None:
        return read_secret(token_file, "--token-file")
    return os.environ.get(TOKEN_VARIABLE) or None

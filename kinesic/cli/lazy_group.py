"""A group of verbs, each imported when it is asked for: none waits for libraries of others, and their list for none."""

from collections.abc import Mapping
from importlib import import_module

import click


class Verbs(click.Group):
    """Commands in modules that bear their names."""

    _modules: Mapping[str, str] = {}  # verb -> module
    _helps: Mapping[str, str] = {}  # verb -> the first sentence of its help, as a list of verbs shows it

    def offer(self, package: str, **verbs: str) -> None:
        """Adds verbs, each in the module of its name in this package, with the first sentence of its help."""
        self._modules = {**self._modules, **{verb: f"{package}.{verb}" for verb in verbs}}
        self._helps = {**self._helps, **verbs}

    def list_commands(self, ctx: click.Context) -> list[str]:
        """All verbs in order."""
        return sorted(self._modules)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """The verb of this name; for one that nobody knows all are there, so that the nearest can be named."""
        for verb in (cmd_name,) if cmd_name in self._modules else self._modules:
            command = getattr(import_module(self._modules[verb]), verb)
            assert isinstance(command, click.Command)
            self.add_command(command, verb)
        return super().get_command(ctx, cmd_name)

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Lists all verbs, of which none is imported."""
        limit = formatter.width - 6 - max(map(len, self._helps))  # as click leaves room
        rows = [(verb, self.short_help_of(verb, limit)) for verb in self.list_commands(ctx)]
        with formatter.section("Commands"):
            formatter.write_dl(rows)

    def short_help_of(self, verb: str, limit: int) -> str:
        """What a verb does, in so many letters."""
        return click.Command(verb, help=self._helps[verb]).get_short_help_str(limit)

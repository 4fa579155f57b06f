"""A group of verbs, each imported when it is asked for: none waits for the libraries of the others."""

from collections.abc import Mapping
from importlib import import_module

import click


class Verbs(click.Group):
    """Commands in modules that bear their names."""

    _modules: Mapping[str, str] = {}  # verb -> module

    def offer(self, package: str, *verbs: str) -> None:
        """Adds verbs, each in the module of its name in this package."""
        self._modules = {**self._modules, **{verb: f"{package}.{verb}" for verb in verbs}}

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

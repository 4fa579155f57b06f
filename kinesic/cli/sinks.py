"""Who performs, as options name it."""

import click

SINKS = ("twin", "servos", "face")
FAULT = 3  # the exit code when one of them failed


class SinkNames(click.ParamType[frozenset[str]]):
    """Names of sinks, with commas between them."""

    name = "sinks"

    def convert(self, value: object, param: click.Parameter | None, ctx: click.Context | None) -> frozenset[str]:
        """Their set."""
        names = frozenset(str(value).split(","))
        if names - set(SINKS):
            self.fail(f"{value!r} is not one of {', '.join(SINKS)}, or several with commas between them", param, ctx)
        return names

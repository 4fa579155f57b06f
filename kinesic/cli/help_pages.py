"""Help pages that list verbs by task, and planning options last."""

from collections.abc import Mapping

import click

VERBS_BY_TASK: Mapping[str, tuple[str, ...]] = {
    "Perform": ("demo", "perform", "say", "plan", "validate", "certify", "face", "export"),
    "Perform live": ("serve", "studio", "mcp"),
    "Gestures, styles and robots": ("gestures", "capture", "styles", "new", "robots"),
    "Servos": ("servos", "twin"),
    "Measure and study": ("sweep", "study", "results", "bench"),
    "Set up": ("doctor", "completion"),
}
OTHER_TASK = "Other"  # heading of verbs without a task
SHARED_HEADING = "Options of planning, the same for all verbs"
MAX_SUMMARY_LENGTH = 120  # [characters] longest summary of a verb that help prints in full


class SharedOption(click.Option):
    """Planning option common to many verbs, listed last in each help page."""


class VerbCommand(click.Command):
    """Verb whose help lists verb-specific options before common planning options."""

    def format_options(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the verb-specific options, then the common planning options."""
        own_rows: list[tuple[str, str]] = []
        shared_rows: list[tuple[str, str]] = []
        for parameter in self.get_params(ctx):
            row = parameter.get_help_record(ctx)
            if row is not None and isinstance(parameter, click.Option):
                (shared_rows if isinstance(parameter, SharedOption) else own_rows).append(row)
        for heading, rows in (("Options", own_rows), (SHARED_HEADING, shared_rows)):
            if rows:
                with formatter.section(heading):
                    formatter.write_dl(rows)


class VerbGroup(click.Group):
    """Group of verbs, sorted by task in the help of `kinesic` itself."""

    command_class = VerbCommand
    group_class = type

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write all verbs with untruncated summaries, sorted by task for `kinesic`."""
        listed = {name for names in VERBS_BY_TASK.values() for name in names}
        others = tuple(name for name in self.list_commands(ctx) if name not in listed)
        tasks = {**VERBS_BY_TASK, OTHER_TASK: others} if ctx.parent is None else {"Commands": self.list_commands(ctx)}
        width = max(map(len, self.commands))
        for task, names in tasks.items():
            rows = [
                (name.ljust(width), self.commands[name].get_short_help_str(MAX_SUMMARY_LENGTH))
                for name in names
                if name in self.commands and not self.commands[name].hidden
            ]
            if rows:
                with formatter.section(task):
                    formatter.write_dl(rows)

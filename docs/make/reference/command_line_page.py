"""The page of the command line, from click's declarations."""

import re
from collections.abc import Iterator

import click

from kinesic.cli import kinesic
from kinesic.cli.help_pages import VERBS_BY_TASK, SharedOption

HEAD = """# Command line

This page lists all commands of kinesic, grouped by task, with their options. `kinesic -h` prints the same list, and
`kinesic VERB -h` prints the options of one command. The page is generated from the program.

Scripts can check the exit code of a command:

| exit code | meaning |
|---|---|
| 0 | success |
| 1 | a check or a metric failed |
| 2 | invalid input or configuration |
| 3 | a robot or servo failed |
| 130 | the command was interrupted |
"""
OPTION_HEAD = ("| option | value | effect | default |", "|---|---|---|---|")
SHARED_SECTION = "Planning options"
SHARED_TEXT = "All commands that plan a motion have these options, in addition to their own."


def write_page() -> str:
    """Return the page of all verbs by task, with shared options."""
    overview: list[str] = []
    sections: list[str] = []
    shared: dict[str, str] = {}
    for task, names in list_tasks().items():
        overview += ["", f"| {task.lower()} | |", "|---|---|"]
        for name in names:
            for path, verb in list_verbs(kinesic.commands[name], ("kinesic", name)):
                overview.append(f"| [`{' '.join(path)}`](#{anchor(path)}) | {summary(verb)} |")
                sections += describe(path, verb, shared)
    planning = [f"## {SHARED_SECTION}", "", SHARED_TEXT, "", *OPTION_HEAD, *shared.values()]
    return "\n".join([HEAD + "\n".join(overview), "", *sections, *planning]) + "\n"


def list_tasks() -> dict[str, tuple[str, ...]]:
    """Return the verbs by task, verbs without a task last."""
    listed = {name for names in VERBS_BY_TASK.values() for name in names}
    others = tuple(name for name in sorted(kinesic.commands) if name not in listed)
    tasks = {**VERBS_BY_TASK, "Other": others}
    return {task: names for task, names in tasks.items() if names}


def list_verbs(verb: click.Command, path: tuple[str, ...]) -> Iterator[tuple[tuple[str, ...], click.Command]]:
    """Yield a verb, or a group's verbs, with their full names."""
    if not isinstance(verb, click.Group):
        yield path, verb
        return
    for name, child in sorted(verb.commands.items()):
        if not child.hidden:
            yield from list_verbs(child, (*path, name))


def anchor(path: tuple[str, ...]) -> str:
    """Return the anchor of a verb's heading."""
    return "-".join(path)


def summary(verb: click.Command) -> str:
    """Return the first sentence of a verb's help."""
    return cell(verb.get_short_help_str(limit=200))


def describe(path: tuple[str, ...], verb: click.Command, shared: dict[str, str]) -> Iterator[str]:
    """Yield the lines of a verb's section, and collect shared options."""
    context = click.Context(verb, info_name=" ".join(path), help_option_names=["-h", "--help"])
    yield f"## {' '.join(path)}"
    yield ""
    usage = " ".join(verb.collect_usage_pieces(context))
    yield f"```\n{' '.join(path)} {usage}\n```"
    yield ""
    yield from prose(verb.help or "")
    options = [option for option in verb.get_params(context) if isinstance(option, click.Option) and not option.hidden]
    own = [option for option in options if "--help" not in option.opts and not isinstance(option, SharedOption)]
    if own:
        yield from [*OPTION_HEAD, *(option_row(option, context) for option in own), ""]
    if planning := [option for option in options if isinstance(option, SharedOption)]:
        for option in planning:
            row = option_row(option, context)
            if shared.setdefault(str(option.name), row) != row:
                raise ValueError(f"{option.opts[0]} of {' '.join(path)} differs from that of other verbs")
        names = ", ".join(f"`{option.opts[0]}`" for option in planning)
        yield from [f"It also has [planning options](#planning-options): {names}.", ""]
    yield from prose(verb.epilog or "")


def prose(text: str) -> Iterator[str]:
    r"""Yield paragraphs of help text, preformatted ones (\b) as code."""
    for paragraph in re.split(r"\n\s*\n", text.replace("\f", "").strip()):
        if paragraph.lstrip().startswith("\b"):
            lines = paragraph.lstrip().removeprefix("\b").strip("\n").splitlines()
            yield from ["```", *(line.rstrip() for line in lines), "```", ""]
        elif paragraph:
            yield from [plain(re.sub(r"\s+", " ", paragraph).strip()), ""]


def option_row(option: click.Option, context: click.Context) -> str:
    """Return the table row of one option."""
    names = " ".join(f"`{name}`" for name in (*option.opts, *option.secondary_opts))
    extra = option.get_help_extra(context)
    default = f"`{extra['default']}`" if "default" in extra else ""
    return f"| {names} | {value_of(option, context)} | {plain(cell(option.help or ''))} | {cell(default)} |"


def value_of(option: click.Option, context: click.Context) -> str:
    """Describe an option's accepted values, empty for flags."""
    if option.is_flag or option.count:
        return ""
    if isinstance(option.type, click.Choice):
        return ", ".join(f"`{choice}`" for choice in option.type.choices)
    words = option.make_metavar(context).replace("|", " or ").removesuffix(" RANGE")
    limits = option.get_help_extra(context).get("range", "")
    return plain(" ".join([words, *([f"({limits})"] if limits else [])]))


def cell(text: str) -> str:
    """Escape a text for a cell of a Markdown table."""
    return re.sub(r"\s+", " ", text).replace("|", "\\|")


def plain(text: str) -> str:
    """Escape < and > in a text."""
    return text.replace("<", "&lt;").replace(">", "&gt;")

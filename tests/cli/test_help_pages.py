import shlex
from collections.abc import Iterator

import click
import pytest
from click.testing import CliRunner

from kinesic.body.config import locate_config
from kinesic.body.robot_extension import read_robot
from kinesic.body.robot_schema import RobotFile
from kinesic.cli import kinesic as command_line
from kinesic.cli.examples import VERB_EXAMPLES
from kinesic.cli.help_pages import OTHER_TASK, VERBS_BY_TASK, SharedOption
from kinesic.studies.designs.variant import Variable, apply_design

EXAMPLE_LINES = [line for lines in VERB_EXAMPLES.values() for line in lines]


def verbs(group: click.Group, *words: str) -> Iterator[tuple[str, click.Command]]:
    """Yield the path and the command of every verb."""
    for name, command in group.commands.items():
        if isinstance(command, click.Group):
            yield from verbs(command, *words, name)
        else:
            yield " ".join((*words, name)), command


def help_of(*words: str) -> str:
    return CliRunner().invoke(command_line, [*words, "-h"], prog_name="kinesic").output


def test_help_groups_every_verb_by_task():
    named = [name for names in VERBS_BY_TASK.values() for name in names]
    differing = set(named) ^ set(command_line.commands)
    assert not differing, "VERBS_BY_TASK in kinesic/cli/help_pages.py lists each verb of kinesic/cli/verbs.py"
    assert len(named) == len(set(named))
    text = help_of()
    assert f"{OTHER_TASK}:" not in text
    headings = [line.rstrip(":") for line in text.splitlines() if line.endswith(":") and not line.startswith(" ")]
    assert headings == ["Options", *VERBS_BY_TASK]


def test_help_shows_the_summary_of_every_verb_completely():
    groups = [(), *((name,) for name, verb in command_line.commands.items() if isinstance(verb, click.Group))]
    assert [words for words in groups if "..." in help_of(*words).replace("[ARGS]...", "")] == []


def test_help_lists_options_of_the_verb_before_shared_options():
    text = help_of("perform")
    own, _, shared = text.partition("Options of planning, the same for all verbs:")
    assert all(option in own for option in ("--robot", "--style", "--on", "--out", "--film-size", "--json", "--help"))
    assert all(option in shared for option in ("--set", "--lexicon", "--seed", "--voice"))
    assert not any(option in own.partition("Options:")[2] for option in ("--lexicon", "--seed", "--qualifiers"))


def test_every_verb_ends_its_help_with_examples():
    differing = set(VERB_EXAMPLES) ^ {path for path, _ in verbs(command_line)}
    assert not differing, "VERB_EXAMPLES in kinesic/cli/examples.py has an example of each verb"
    for path in VERB_EXAMPLES:
        text = help_of(*path.split())
        assert text.rstrip().endswith(f"  {VERB_EXAMPLES[path][-1]}"), path


@pytest.mark.parametrize("line", EXAMPLE_LINES)
def test_help_examples_are_valid_command_lines(line):
    program, *words = shlex.split(line.partition(" >>")[0])
    assert program == "kinesic"
    command: click.Command = command_line
    while isinstance(command, click.Group):
        command = command.commands[words.pop(0)]
    command.make_context("kinesic", words, **command_line.context_settings)


def test_help_example_of_a_search_varies_a_body_of_its_robot():
    (line,) = VERB_EXAMPLES["robots search"]
    words = shlex.split(line)
    variable = Variable.parse(words[words.index("--vary") + 1])
    path = locate_config("robot", words[3])
    file = read_robot(path, RobotFile)
    assert [apply_design(file, ((variable.name, value),), path) == file for value in variable.values] == [False, False]


def test_shared_options_in_the_help_are_the_planning_options():
    shared = {option.name for option in command_line.commands["plan"].params if isinstance(option, SharedOption)}
    assert {"settings", "lexicon", "seed", "voice", "pause"} <= shared
    assert "out" not in shared

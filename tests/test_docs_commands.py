"""Commands, programs and their outputs on documentation pages."""

import re
import shlex
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import click
import pytest

from kinesic import Performer
from kinesic.cli.verbs import kinesic

from .naming import about

ROOT = Path(__file__).resolve().parent.parent
USAGE_LINES = ROOT / "docs" / "reference" / "command-line.md"  # generated page of usage lines with placeholders
PAGES = [
    ROOT / "README.md",
    *(page for page in sorted((ROOT / "docs").rglob("*.md")) if page != USAGE_LINES),
    *sorted((ROOT / "skills").glob("*/SKILL.md")),
]
SHELL_ENDS = ("|", "&", "&&", ";", ">", "<", "2>")  # shell words at which a command ends
PROGRAM_PAGES = (
    "how-to/use-from-python.md",
    "how-to/export-a-motion.md",
    "explanation/virtual-human.md",
    "explanation/inverse-kinematics.md",
)
OUTPUT_TOLERANCE = 0.02  # [s] largest difference of a time shown on a page


def list_commands(page: Path) -> Iterator[list[str]]:
    """Yield the arguments of each command `kinesic` in the code blocks of a page."""
    for block in re.findall(r"```\w*[^\n]*\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL):
        for line in re.sub(r"\\\n\s*", "", block).splitlines():
            if re.match(r"(\.venv/bin/)?kinesic [a-z-]", line):
                words = shlex.split(line, comments=True)[1:]
                yield words[: next((k for k, word in enumerate(words) if word in SHELL_ENDS), None)]


def parse_command(words: list[str]) -> None:
    """Parse a command without running it.

    Raises:
        click.UsageError: a verb, an option, a value or an argument is wrong.
    """
    command: click.Command = kinesic
    context = click.Context(kinesic, info_name="kinesic", **kinesic.context_settings)
    while isinstance(command, click.Group) and words:
        name, found, words = command.resolve_command(context, words)
        assert found is not None
        command, context = found, click.Context(found, parent=context, info_name=name)
    command.make_context(command.name, list(words), parent=context.parent)


def test_documented_commands_have_valid_verbs_options_and_values():
    for page in PAGES:
        for words in list_commands(page):
            with about(f"{page.relative_to(ROOT)}: kinesic {shlex.join(words)}"):
                parse_command(words)


def test_wrong_options_and_verbs_of_documented_commands_are_rejected(tmp_path: Path):
    page = tmp_path / "page.md"
    page.write_text("```\nkinesic perform a.bml --styel joyful  # a style\n```\n", encoding="utf-8")
    (words,) = list_commands(page)
    assert words == ["perform", "a.bml", "--styel", "joyful"]
    with pytest.raises(click.UsageError, match="--styel"):
        parse_command(words)
    with pytest.raises(click.UsageError, match="greet"):
        parse_command(["greet"])


def test_example_of_the_certificate_page_gives_the_shown_warning():
    text = (ROOT / "docs" / "explanation" / "certificate.md").read_text(encoding="utf-8")
    document = re.search(r"```xml\n(.*?)```", text, re.DOTALL)
    shown = re.search(r"```text\nwarning +\S+ \((\w+)\): (.*) planned at (\S+) s: (.*)\n```", text)
    assert document
    assert shown
    behaviour, before, time, reason = shown.groups()
    (notice,) = Performer().plan(document[1]).notices
    assert notice.id == f"b:{behaviour}"
    actual = re.fullmatch(r"(.*) planned at (\S+) s: (.*)", notice.text)
    assert actual
    assert (actual[1], actual[3]) == (before, reason)
    assert float(actual[2]) == pytest.approx(float(time), abs=OUTPUT_TOLERANCE)


@pytest.mark.soak
@pytest.mark.parametrize("page", PROGRAM_PAGES)
def test_python_examples_of_a_documentation_page_run_in_an_empty_folder(page: str, tmp_path: Path):
    blocks = re.findall(r"```python\n(.*?)```", (ROOT / "docs" / page).read_text(encoding="utf-8"), re.DOTALL)
    (tmp_path / "example.py").write_text("\n".join(blocks), encoding="utf-8")
    ended = subprocess.run([sys.executable, "example.py"], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert ended.returncode == 0, ended.stderr
    if page == "how-to/use-from-python.md":
        listed = ended.stdout.splitlines()[0]
        assert listed.startswith("True ["), "nothing fails"
        assert "limits.speed" not in listed, "only checks that do not pass are listed"

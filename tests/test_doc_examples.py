"""Examples in the documentation: commands, documents, files and Python."""

import json
import re
import shlex
import tomllib
from collections.abc import Iterator
from inspect import signature
from pathlib import Path

import click
import pytest

from kinesic.bml.parse import parse
from kinesic.cli import kinesic as command
from kinesic.report.run import Performance

ROOT = Path(__file__).resolve().parent.parent
GENERATED_PAGES = {
    "command-line.md",
    "examples.md",
}  # generated pages, with usage lines and whole programs instead of examples
SKILLS = sorted((ROOT / "skills").glob("*/SKILL.md"))
PAGES = [
    ROOT / "README.md",
    ROOT / "AGENTS.md",
    *SKILLS,
    *sorted(page for page in (ROOT / "docs").rglob("*.md") if page.name not in GENERATED_PAGES),
]
SHELL_LINE = re.compile(r"^(?:\$ )?(?:\w+=\S* )*(?:\.venv/bin/)?kinesic (?P<words>.*)$", re.MULTILINE)
PLACEHOLDER_PATTERN = re.compile(r"^(\.\.\.|[A-Z]+|\W+)$")
CHEAP_SKILLS = {
    "write-a-sink",
    "read-a-report",
    "stream-bml",
    "export-gltf",
}  # skills whose examples run in the test; the others would perform several times
RUN_PAGES = [  # pages whose Python examples run in the test; other examples need a display
    *(page for page in SKILLS if page.parent.name in CHEAP_SKILLS),
    ROOT / "README.md",
    ROOT / "docs" / "explanation" / "inverse-kinematics.md",
    ROOT / "docs" / "how-to" / "connect-a-voice.md",
    ROOT / "docs" / "how-to" / "use-from-python.md",
]  # others need a display


def page_name(page: Path) -> str:
    return page.parent.name if page.name == "SKILL.md" else page.stem


def blocks(page: Path, language: str) -> list[str]:
    fences = re.findall(r"^ *```(.*?)\n(.*?)^ *```", page.read_text(encoding="utf-8"), re.DOTALL | re.MULTILINE)
    return [text for name, text in fences if re.fullmatch(language, name)]


def shell_lines() -> Iterator[tuple[str, str]]:
    """Yield the page and the words of each command in a block without a language."""
    for page in PAGES:
        for block in blocks(page, "(?:sh|bash|console)?"):
            for line in SHELL_LINE.finditer(block.replace("\\\n", " ")):
                yield page.name, line["words"]


def find_verb(words: list[str]) -> tuple[click.Command, list[str]]:
    """Split the words of a command into its verb and its arguments."""
    verb: click.Command = command
    while isinstance(verb, click.Group) and words and not words[0].startswith("-"):
        if words[0] not in verb.commands:
            raise click.UsageError(f"no verb {words[0]}")
        verb, words = verb.commands[words[0]], words[1:]
    return verb, words


def test_commands_in_the_documentation_are_valid():
    failures = []
    for page, text in (lines := list(shell_lines())):
        words = shlex.split(text, comments=True)
        end = next((index for index, word in enumerate(words) if word in ("|", "<", ">", "&&", "&", ";")), len(words))
        try:
            verb, rest = find_verb(words[:end])
            if not isinstance(verb, click.Group):
                verb.make_context(str(verb.name), list(rest), **command.context_settings)
        except click.exceptions.Exit:  # --help and --version
            continue
        except click.ClickException as error:
            failures.append(f"{page}: kinesic {text}: {error.format_message()}")
    assert len(lines) > 50
    assert failures == []


def test_commands_and_options_in_documentation_text_exist():
    failures, count = [], 0
    for page in PAGES:
        prose = re.sub(r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.DOTALL | re.MULTILINE)
        for text in re.findall(r"`kinesic ([a-z][^`]*)`", prose):
            count += 1
            first = text.split("#")[0].replace("|", " ").split()
            try:
                verb, rest = find_verb([word for word in first if not PLACEHOLDER_PATTERN.match(word)])
            except click.UsageError as error:
                failures.append(f"{page.name}: {text}: {error.message}")
                continue
            known = {name for option in verb.params for name in (*option.opts, *option.secondary_opts)} | {"--help"}
            options = [word.split("=")[0].strip("[]") for word in rest if word.startswith(("--", "[--"))]
            failures += [f"{page.name}: {text}: no option {option}" for option in options if option not in known]
    assert count > 100
    assert failures == []


@pytest.mark.parametrize("page", [page for page in PAGES if blocks(page, "xml")], ids=page_name)
def test_bml_examples_in_the_documentation_are_valid_without_warnings(page: Path):
    for text in blocks(page, "xml"):
        block = parse(text if "<bml" in text else f'<bml id="b">{text}</bml>')
        assert block.behaviours
        assert [notice.text for notice in block.notices] == []


@pytest.mark.parametrize("page", [page for page in PAGES if blocks(page, "json")], ids=page_name)
def test_json_examples_in_the_documentation_are_valid(page: Path):
    for text in blocks(page, "json"):
        if "behaviours" in json.loads(text):
            assert parse(text).notices == ()


@pytest.mark.parametrize("page", [page for page in PAGES if blocks(page, "toml")], ids=page_name)
def test_toml_examples_in_the_documentation_are_valid(page: Path):
    assert all(tomllib.loads(text) for text in blocks(page, "toml"))


@pytest.mark.parametrize("page", RUN_PAGES, ids=page_name)
def test_python_examples_in_the_documentation_run(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """Examples of one page run in sequence, with shared variables."""
    monkeypatch.chdir(tmp_path)
    report = signature(Performance.report)

    def check_call(run: Performance, *given: object) -> None:  # writing is slow
        report.bind(run, *given)

    monkeypatch.setattr(Performance, "report", check_call)
    names: dict[str, object] = {"__name__": "example"}
    texts = blocks(page, "python")
    assert texts
    for text in texts:
        exec(compile(text, str(page), "exec"), names)


@pytest.mark.soak
@pytest.mark.parametrize("page", [ROOT / "AGENTS.md", *SKILLS], ids=page_name)
def test_python_examples_of_all_skills_run(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {"__name__": "example"}
    for text in blocks(page, "python"):
        exec(compile(text, str(page), "exec"), names)


@pytest.mark.parametrize("page", SKILLS, ids=page_name)
def test_skill_pages_begin_with_their_name_and_purpose(page: Path):
    front = re.match(r"---\nname: ([\w-]+)\ndescription: (.+)\n---\n\n# ", page.read_text(encoding="utf-8"))
    assert front is not None
    assert front[1] == page.parent.name
    assert len(front[2]) > 60, "a program chooses a skill by its description"


def test_agents_page_names_each_skill_once():
    text = (ROOT / "AGENTS.md").read_text(encoding="utf-8")
    assert sorted(re.findall(r"\[([\w-]+)\]\(skills/\1/SKILL\.md\)", text)) == [page.parent.name for page in SKILLS]
    assert len(text.splitlines()) <= 140, "move details to a skill"


def test_report_keys_listed_by_the_report_skill_exist():
    page = (ROOT / "skills" / "read-a-report" / "SKILL.md").read_text(encoding="utf-8")
    sources = "".join(file.read_text(encoding="utf-8") for file in (ROOT / "kinesic" / "report").glob("*.py"))
    keys = re.findall(r"^\| `([\w.]+)` \|", page, re.MULTILINE)
    assert len(keys) > 8
    missing = [key for key in keys if not re.search(rf"\b{key.split('.')[-1]}\b", sources)]
    assert missing == []

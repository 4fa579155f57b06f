"""How a page is followed: files, commands, outputs, a second terminal and Enter."""

from pathlib import Path

import pytest

from tests.tutorials.pages import execute, read_page
from tests.tutorials.terminals import TutorialError, matches

SECOND = """
```bash title="second terminal"
trap 'echo end; exit 0' INT; echo waiting; read line; echo "got it"; while true; do sleep 0.1; done
```

```text
waiting
```

<!-- press-enter: second terminal -->

```text
waiting
got it
```
"""


def follow(text: str, folder: Path) -> None:
    (folder / "page.md").write_text(text, encoding="utf-8")
    (folder / "empty").mkdir()
    execute(read_page(folder / "page.md"), folder / "empty")


def block(info: str, *lines: str) -> str:
    return "\n".join((f"```{info}", *lines, "```", ""))


def test_tutorial_page_writes_its_files_and_compares_outputs(tmp_path: Path):
    file = block('python title="hello.py"', "print('one', 1.25)", "print('two')", "print('three')")
    follow(file + block("bash", "python hello.py") + block("text", "one   7.5", "...", "three"), tmp_path)
    assert (tmp_path / "empty" / "hello.py").is_file()


@pytest.mark.parametrize(
    "shown", [("one", "three"), ("one",), ("two",), ("one", "two", "three"), ("one", "...", "three")]
)
def test_tutorial_output_that_differs_from_its_page_is_an_error(tmp_path: Path, shown: tuple[str, ...]):
    with pytest.raises(TutorialError, match="but the page shows"):
        follow(block("bash", "echo one", "echo two") + block("text", *shown), tmp_path)


def test_failing_command_of_a_tutorial_is_an_error(tmp_path: Path):
    with pytest.raises(TutorialError, match="ended with 3 and printed\n\nhalf"):
        follow(block("bash", "echo half; exit 3"), tmp_path)


def test_tutorial_block_marked_as_skipped_is_not_executed(tmp_path: Path):
    follow(
        "<!--- skip: next -->\n" + block("bash", "exit 1") + block("bash", "echo on") + block("text", "on"), tmp_path
    )


def test_commands_in_a_second_terminal_run_until_the_end_of_the_tutorial(tmp_path: Path):
    follow(SECOND + block("bash", "echo first") + block("text", "first"), tmp_path)


@pytest.mark.parametrize(
    ("shown", "printed", "same"),
    [
        ("at 1.20 s", "at  31.7 s", True),
        ("at 1.20 s", "at 1 s", False),
        ("23 servos", "69 servos", False),
        ("a\n...\nc", "a\nb\nb\nc", True),
        ("a\n...\nc", "a\nb", False),
        ("id mcp-...: done", "id mcp-31f: done", True),
    ],
)
def test_only_decimals_and_ellipses_in_tutorial_outputs_are_wildcards(shown: str, printed: str, same: bool):
    assert matches(shown, printed) is same

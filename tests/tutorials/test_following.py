"""How a page is followed: files, commands, outputs, a second terminal and Enter."""

from pathlib import Path

import pytest

from tests.tutorials.outputs import matches
from tests.tutorials.pages import execute, read_page
from tests.tutorials.terminals import TutorialError

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


def test_files_of_a_tutorial_are_written_and_its_outputs_compared(tmp_path: Path):
    file = block('python title="hello.py"', "print('one', 1.25)", "print('two')", "print('three')")
    follow(file + block("bash", "python hello.py") + block("text", "one   1.24", "...", "three"), tmp_path)
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
        ("at 1.20 s", "at  1.21 s", True),
        ("at 1.20 s", "at  1.223 s", True),
        ("at 1.20 s", "at  1.23 s", False),
        ("at 120.0 s", "at 122.3 s", True),
        ("at 120.0 s", "at 122.5 s", False),
        ("0.02 0.0", "0.03 -0.1", True),
        ("0.02", "0.04", False),
        ("at 1.20 s", "at 1 s", False),
        ("0.2.0", "0.2.1", False),
        ('{"seconds": 5.58, "x"...', '{"seconds": 5.60, "x": [1, 2]}', True),
        ("a ... 1.50 b", "a 2.50 b 1.50 b", True),
        ("a ... 1.50 b", "a 1.50 b 2.50 b", False),
        ("nothing fails...", "nothing fails; 1 warning", True),
        ("23 servos", "69 servos", False),
        ("a\n...\nc", "a\nb\nb\nc", True),
        ("a\n...\nc", "a\nb", False),
        ("id mcp-...: done", "id mcp-31f: done", True),
    ],
)
def test_outputs_of_tutorial_commands_are_compared_word_by_word_with_a_tolerance(shown: str, printed: str, same: bool):
    assert matches(shown, printed) is same


def test_tutorial_output_marked_measured_may_have_other_decimal_numbers_but_not_other_integers(tmp_path: Path):
    assert not matches("1.20 s 3", "7.5 s 4", is_measured=True)
    assert not matches("1.20 s", "7 s", is_measured=True)
    mark, shown = "<!-- measured: next -->\n", block("text", "1.20 s")
    follow(block("bash", "echo 1.21 s") + shown + block("bash", "echo 7.5 s") + mark + shown, tmp_path)


def test_measured_mark_in_a_tutorial_applies_only_to_the_next_output(tmp_path: Path):
    text = "<!-- measured: next -->\n" + block("text", "1.20") + block("bash", "echo 8.5") + block("text", "1.20")
    with pytest.raises(TutorialError, match="but the page shows"):
        follow(block("bash", "echo 7.5") + text, tmp_path)

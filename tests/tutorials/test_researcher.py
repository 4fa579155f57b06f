from pathlib import Path

import pytest

from tests.tutorials.pages import execute, read_tutorial

pytestmark = pytest.mark.tutorial


def test_commands_of_the_researcher_tutorial_print_the_shown_outputs_and_write_a_report(tmp_path: Path):
    folder = tmp_path / "my-bml"
    folder.mkdir()
    execute(read_tutorial("researcher"), folder)
    assert (folder / "joyful" / "report.html").is_file()

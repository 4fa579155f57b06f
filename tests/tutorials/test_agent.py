from pathlib import Path

import pytest

from tests.tutorials.pages import execute, read_tutorial

pytestmark = [pytest.mark.tutorial, pytest.mark.realtime]


def test_commands_of_the_agent_tutorial_print_the_shown_outputs_and_write_a_report(tmp_path: Path):
    folder = tmp_path / "my-agent"
    folder.mkdir()
    execute(read_tutorial("agent"), folder)
    assert (folder / "said" / "report.html").is_file()

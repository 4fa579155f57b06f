from pathlib import Path

import pytest

from tests.tutorials.pages import execute, read_tutorial

pytestmark = [pytest.mark.tutorial, pytest.mark.realtime]


def test_agent_tutorial_works_as_shown(tmp_path: Path):
    folder = tmp_path / "my-agent"
    folder.mkdir()
    execute(read_tutorial("agent"), folder)
    assert (folder / "said" / "report.html").is_file()

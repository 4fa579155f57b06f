from pathlib import Path

import pytest

from tests.tutorials.pages import execute, read_tutorial

pytestmark = pytest.mark.tutorial


def test_researcher_tutorial_works_as_shown(tmp_path: Path):
    folder = tmp_path / "my-bml"
    folder.mkdir()
    execute(read_tutorial("researcher"), folder)
    assert (folder / "joyful" / "report.html").is_file()

from pathlib import Path

import pytest

from kinesic.hardware.supervisor.address import find_supervisors
from tests.tutorials.pages import execute, read_tutorial

pytestmark = [pytest.mark.tutorial, pytest.mark.realtime]


def test_maker_tutorial_works_as_shown(tmp_path: Path):
    if any(find_supervisors()):
        pytest.skip("a robot is driven from this machine, and the tutorial would stop it")
    folder = tmp_path / "my-robot"
    folder.mkdir()
    execute(read_tutorial("maker"), folder)
    assert (folder / "wave" / "servos.npz").is_file()

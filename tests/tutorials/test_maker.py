from pathlib import Path

import pytest

from kinesic.hardware.supervisor.address import find_supervisors
from tests.tutorials.pages import execute, read_tutorial

pytestmark = [pytest.mark.tutorial, pytest.mark.realtime]


def test_commands_of_the_maker_tutorial_print_the_shown_outputs_and_log_the_servos(tmp_path: Path):
    if any(find_supervisors()):
        pytest.skip("a robot is driven from this machine, and the tutorial would stop it")
    folder = tmp_path / "my-robot"
    folder.mkdir()
    execute(read_tutorial("maker"), folder)
    assert (folder / "wave" / "servos.npz").is_file()

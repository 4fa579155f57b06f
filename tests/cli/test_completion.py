import shutil
import subprocess

import pytest
from click.shell_completion import ShellComplete

from kinesic.cli import kinesic as command_line
from kinesic.cli.completion import SHELL_NAMES


def complete(*words: str) -> list[str]:
    """Return a shell's completions of the last word, without files."""
    *before, incomplete = words
    completer = ShellComplete(command_line, {}, "kinesic", "_KINESIC_COMPLETE")
    return [item.value for item in completer.get_completions(list(before), incomplete) if item.type == "plain"]


def test_shell_completion_completes_names_of_styles_robots_gestures_and_verbs():
    assert complete("perform", "my.bml", "--style", "j") == ["joyful"]
    assert complete("perform", "my.bml", "--robot", "upper") == ["upper22", "upper36"]
    assert complete("robots", "show", "hu") == ["human"]
    assert complete("gestures", "show", "greet_w") == ["greet_wave"]
    assert {"beat_small", "beat_strong"} <= {*complete("sweep", "beat_s")}
    assert "welcome" in complete("perform", "")
    assert complete("validate", "welcome", "st") == ["story"]
    assert complete("gest") == ["gestures"]
    assert "--style" in complete("perform", "--st")


def test_shell_completion_completes_files_for_options_that_accept_them():
    completer = ShellComplete(command_line, {}, "kinesic", "_KINESIC_COMPLETE")
    assert "file" in [item.type for item in completer.get_completions(["perform"], "my")]
    assert "file" not in [item.type for item in completer.get_completions(["gestures", "show"], "my")]


@pytest.mark.parametrize("shell", SHELL_NAMES)
def test_shell_completion_script_of_each_shell_calls_kinesic(kinesic, shell):
    ended = kinesic("completion", shell)
    assert ended.code == 0
    assert f"_KINESIC_COMPLETE={shell}_complete" in ended.out
    if shutil.which(shell):
        checked = subprocess.run([shell, "-n"], input=ended.out, capture_output=True, text=True, check=False)
        assert (checked.returncode, checked.stderr) == (0, "")

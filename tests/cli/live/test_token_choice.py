"""Choice of a server's token from command line, file or environment."""

import subprocess
import sys
from pathlib import Path

import click
import pytest
from click.testing import CliRunner

from kinesic.body.config import ConfigError
from kinesic.cli.live import token as token_module
from kinesic.cli.live.token import SHOWN_WARNING, TOKEN_VARIABLE, token_option

TOKEN = "open-sesame"


@pytest.fixture
def hidden(monkeypatch: pytest.MonkeyPatch) -> list[bool]:
    """Record calls that hide the token, with no token in the environment."""
    calls: list[bool] = []
    monkeypatch.setattr(token_module, "hide_token", lambda: calls.append(True))
    monkeypatch.delenv(TOKEN_VARIABLE, raising=False)
    return calls


@pytest.fixture
def token_file(tmp_path: Path) -> Path:
    path = tmp_path / "token"
    path.write_text(f"{TOKEN}\nanother line\n")
    path.chmod(0o600)
    return path


def run(*arguments: str) -> tuple[object, str]:
    """Return the token passed to a verb, and the standard error output."""
    results: list[object] = []

    @click.command()
    @token_option("Help.")
    @click.option("--other", default=1)
    def verb(*, token: str | None, other: int) -> int:
        assert other == 2
        results.append(token)
        return 0

    result = CliRunner().invoke(verb, [*arguments, "--other", "2"], standalone_mode=False)
    if result.exception is not None:
        raise result.exception
    return results[0], result.stderr


def test_token_on_the_command_line_is_hidden_with_a_warning(hidden: list[bool]) -> None:
    token, errors = run("--token", TOKEN)
    assert token == TOKEN
    assert errors == f"{SHOWN_WARNING}\n"
    assert hidden == [True]


def test_token_file_causes_no_warning(hidden: list[bool], token_file: Path) -> None:
    assert run("--token-file", str(token_file)) == (TOKEN, "")
    assert hidden == []


def test_token_defaults_to_that_of_the_environment_variable(
    hidden: list[bool], token_file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert run() == (None, "")
    monkeypatch.setenv(TOKEN_VARIABLE, "")
    assert run() == (None, "")
    monkeypatch.setenv(TOKEN_VARIABLE, "from-environment")
    assert run() == ("from-environment", "")
    assert run("--token-file", str(token_file))[0] == TOKEN
    assert run("--token", "given")[0] == "given"
    assert run("--token", "")[0] is None, "an empty one means none, also instead of that of the environment"


def test_token_option_and_token_file_together_are_refused(hidden: list[bool], token_file: Path) -> None:
    with pytest.raises(click.UsageError, match="give one of them"):
        run("--token", TOKEN, "--token-file", str(token_file))
    assert hidden == [True]


def test_token_file_that_is_missing_or_readable_by_others_is_refused(hidden: list[bool], token_file: Path) -> None:
    token_file.chmod(0o640)
    with pytest.raises(ConfigError, match=r"--token-file .*other users can read it"):
        run("--token-file", str(token_file))
    with pytest.raises(ConfigError, match="No such file"):
        run("--token-file", str(token_file) + "x")


@pytest.mark.skipif(not Path("/proc/self/mem").exists(), reason="this system does not show arguments in /proc")
def test_token_option_is_overwritten_in_the_list_of_processes() -> None:
    program = (
        "from pathlib import Path; from kinesic.cli.live.token import hide_token; hide_token(); "
        "print(Path('/proc/self/cmdline').read_bytes().split(bytes(1))[-4:])"
    )
    arguments = [sys.executable, "-c", program, "--token", TOKEN, "--text"]
    shown = subprocess.run(arguments, capture_output=True, text=True, check=True).stdout
    assert shown.strip() == str([b"--token", b"x" * len(TOKEN), b"--text", b""])

"""Remedies for packages of extras that are not installed."""

import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from kinesic.cli.extras import EXTRA_OF_PACKAGE, explain_missing
from kinesic.extras import install_extra

ROOT = Path(__file__).resolve().parents[2]
EXTRAS = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["optional-dependencies"]
HIDING_PROGRAM = """
import sys
hidden = sys.argv.pop(1)
class Absent:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] == hidden:
            raise ModuleNotFoundError(f"No module named {hidden!r}", name=name)
sys.meta_path.insert(0, Absent())
from kinesic.cli import main
main()
"""


def run_without(package: str, folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Run the command line while a package cannot be imported."""
    command = [sys.executable, "-c", HIDING_PROGRAM, package, *arguments]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)


@pytest.mark.parametrize(
    "arguments",
    [
        ("sweep", "beat", "--parameter", "power"),
        pytest.param(("gestures", "render", "beat", "--out", "beat.png"), marks=pytest.mark.soak),
    ],
)
def test_missing_matplotlib_is_reported_in_one_line_with_its_extra(arguments, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    ended = run_without("matplotlib", tmp_path, *arguments)
    assert ended.returncode == 2
    assert ended.stderr == f"kinesic: this needs matplotlib: {install_extra('plots')}\n"
    assert list(tmp_path.iterdir()) == []


@pytest.mark.soak
def test_missing_viewer_library_is_reported_in_one_line_with_its_extra(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    ended = run_without("rerun", tmp_path, "export", "welcome", "--to", "rerun")
    assert ended.returncode == 2
    assert ended.stderr == f"kinesic: this needs rerun: {install_extra('rerun')}\n"
    assert list(tmp_path.iterdir()) == []


def test_gestures_show_command_works_without_matplotlib(tmp_path):
    ended = run_without("matplotlib", tmp_path, "gestures", "show", "beat")
    assert (ended.returncode, ended.stderr) == (0, "")


def test_missing_required_package_is_reported_with_its_traceback(tmp_path):
    ended = run_without("msgspec", tmp_path, "gestures", "show", "beat")
    assert "No module named 'msgspec'" in ended.stderr
    assert "kinesic[" not in ended.stderr


@pytest.mark.parametrize("package", EXTRA_OF_PACKAGE)
def test_install_command_for_a_missing_package_names_an_extra_that_contains_the_package(package):
    line = explain_missing(ModuleNotFoundError(f"No module named '{package}.part'", name=f"{package}.part"))
    extra = EXTRA_OF_PACKAGE[package]
    name, distribution = ("Pillow", "pillow") if package == "PIL" else (package, package)
    assert line == f"this needs {name}: {install_extra(extra)}"
    needed = "distributed" if package == "dask" else distribution  # which requires dask
    assert any(each.startswith(needed) for each in EXTRAS[extra])


def test_extra_all_contains_all_user_extras_except_rerun():
    (named,) = EXTRAS["all"]
    for_maintainers, too_large = {"all", "bench", "robots", "dev", "docs", "release", "compiler"}, {"rerun"}
    assert (
        set(named.removeprefix("kinesic[").removesuffix("]").split(",")) == EXTRAS.keys() - for_maintainers - too_large
    )

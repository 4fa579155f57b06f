"""Commands that error messages name for missing packages."""

import ast
import shutil
import subprocess
import sys
import sysconfig
import tomllib
from collections.abc import Iterator
from pathlib import Path

import pytest

from kinesic import extras
from kinesic.extras import install_command, install_extra

ROOT = Path(__file__).resolve().parents[1]
EXTRAS = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["optional-dependencies"]
SOURCES = sorted(path for path in (ROOT / "kinesic").rglob("*.py") if "node_modules" not in path.parts)


def list_requested_extras() -> Iterator[str]:
    """Yield the literal argument of every call of `install_extra`."""
    for path in SOURCES:
        text = path.read_text(encoding="utf-8")
        for node in ast.walk(ast.parse(text)) if "install_extra(" in text else ():
            if isinstance(node, ast.Call) and ast.unparse(node.func) == "install_extra":
                yield from (argument.value for argument in node.args if isinstance(argument, ast.Constant))


@pytest.fixture
def environment(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    """Enter a folder with an inactive virtual environment `.venv`."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "executable", str(tmp_path / ".venv" / "bin" / "python"))
    monkeypatch.setattr(shutil, "which", lambda name: f"/usr/bin/{name}")
    return tmp_path


def test_pip_install_commands_are_composed_in_one_module():
    spelled = [path for path in SOURCES if "pip install" in path.read_text(encoding="utf-8")]
    assert spelled == [ROOT / "kinesic" / "extras.py"]


def test_every_extra_named_in_a_message_exists():
    requested = set(list_requested_extras())
    assert len(requested) >= 6
    assert requested <= EXTRAS.keys()


def test_install_command_in_the_active_environment_is_a_plain_pip_command(monkeypatch):
    monkeypatch.setattr(shutil, "which", lambda name: str(Path(sysconfig.get_path("scripts"), name)))
    assert install_extra("face") == 'pip install "kinesic[face]"'


def test_install_command_names_the_interpreter_if_another_pip_comes_first(environment):
    assert install_command() == f"{Path('.venv', 'bin', 'python')} -m pip install"


def test_install_command_gives_the_full_path_from_other_folders(environment, monkeypatch):
    (environment / "elsewhere").mkdir()
    monkeypatch.chdir(environment / "elsewhere")
    assert install_command() == f"{environment / '.venv' / 'bin' / 'python'} -m pip install"


def test_install_command_quotes_an_interpreter_path_with_spaces(environment, monkeypatch):
    monkeypatch.setattr(sys, "executable", "/my programs/python")
    assert install_command() == '"/my programs/python" -m pip install'


def test_install_command_uses_uv_in_an_environment_without_pip(environment, monkeypatch):
    monkeypatch.setattr(extras, "_has_pip", lambda: False)
    assert install_command() == f"uv pip install --python {Path('.venv', 'bin', 'python')}"


def test_install_command_does_not_prevent_a_later_import_of_setuptools():
    pytest.importorskip("setuptools")
    script = "import shutil; shutil.which = lambda name: None; from kinesic.extras import install_command"
    ended = subprocess.run(
        [sys.executable, "-c", f"{script}; print(install_command()); import setuptools"],
        capture_output=True,
        check=True,
    )
    assert ended.stdout.endswith(b"-m pip install\n")


def test_install_command_of_uninstalled_sources_names_their_folder(tmp_path):
    """Sources on the search path, without metadata of an installed package."""
    (tmp_path / "kinesic").symlink_to(ROOT / "kinesic")
    script = "from kinesic.extras import install_extra; print(install_extra('mcp'))"
    script = f"import sys; sys.path.insert(0, {str(tmp_path)!r}); {script}"
    command = [sys.executable, "-S", "-c", script]
    ended = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=True)
    assert ended.stdout.endswith(f' "{ROOT}[mcp]"\n')


def test_pip_accepts_the_installed_kinesic_for_an_extra_without_an_index():
    command = [sys.executable, "-m", "pip", "install", "--dry-run", "--no-index", "--no-deps", "kinesic[rerun]"]
    ended = subprocess.run(command, capture_output=True, text=True, check=False)
    assert ended.returncode == 0, ended.stderr
    assert "already satisfied: kinesic[rerun]" in ended.stdout

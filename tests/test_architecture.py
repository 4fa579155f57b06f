"""Structure of the whole project."""

import ast
import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
PACKAGE = ROOT / "kinesic"
PACKAGES = (
    *("body", "files", "bml", "motion", "expressivity", "ik", "planning", "sim", "hardware", "face", "speech"),
    *(
        "intent",
        "session",
        "controller",
        "metrics",
        "capture",
        "conversation",
        "hearing",
        "realizer",
        "serve",
        "report",
        "studies",
        "studio",
        "mcp",
        "tasks",
        "bench",
        "cli",
        "configs",
        "_kernel",
    ),
)
ROOT_LINKS = ("controller", "ik", "expressivity", "sim", "hardware", "configs")
MAX_FILE_LINES = 320


def sources() -> list[Path]:
    """Return all Python files of package, tests and examples."""
    return sorted(path for folder in ("kinesic", "tests", "examples") for path in (ROOT / folder).rglob("*.py"))


def test_imports_follow_the_layers_of_the_architecture():
    lint = Path(sys.executable).with_name("lint-imports")
    if not lint.exists():
        pytest.skip("import-linter is not installed")
    done = subprocess.run([lint, "--no-cache"], cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


def test_source_files_do_not_exceed_the_line_limit():
    long = {str(path.relative_to(ROOT)): len(path.read_text(encoding="utf-8").splitlines()) for path in sources()}
    assert {name: lines for name, lines in long.items() if lines > MAX_FILE_LINES} == {}


def test_package_folders_are_exactly_those_of_the_layer_list():
    folders = {path.name for path in PACKAGE.iterdir() if path.is_dir() and path.name != "__pycache__"}
    assert folders == set(PACKAGES)


def test_each_folder_with_code_is_a_package():
    folders = {path.parent for path in PACKAGE.rglob("*.py")}
    assert [str(folder.relative_to(ROOT)) for folder in sorted(folders) if not (folder / "__init__.py").exists()] == []


def test_each_package_docstring_begins_with_one_sentence():
    for init in sorted(PACKAGE.rglob("__init__.py")):
        first_line, _, _ = (ast.get_docstring(ast.parse(init.read_text(encoding="utf-8"))) or "").partition("\n")
        assert first_line.endswith("."), (init, first_line)
        assert not re.search(r"\. [A-Z]", first_line), (init, first_line)


@pytest.mark.parametrize("name", ROOT_LINKS)
def test_symlinks_in_the_repository_root_are_relative(name: str):
    link = ROOT / name
    if not link.is_symlink():
        pytest.skip("this checkout has no symbolic links")
    assert os.readlink(link) == f"kinesic/{name}"
    assert link.resolve() == PACKAGE / name


def test_each_package_has_a_test_folder_with_tests():
    for room in set(PACKAGES) - {"configs", "_kernel"}:
        assert next((ROOT / "tests" / room).rglob("test_*.py"), None), f"tests/{room} has no test"


def test_no_test_folder_of_a_package_is_excluded_from_collection():
    """A pattern without a slash that matches a root link would also skip the test folder of that name."""
    options = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]
    skipped = {*options["pytest"]["ini_options"].get("norecursedirs", []), *options["ruff"].get("extend-exclude", [])}
    assert skipped.isdisjoint(PACKAGES)


def test_license_is_apache_2():
    text = (ROOT / "LICENSE").read_text(encoding="utf-8")
    assert "Apache License" in text
    assert "Version 2.0, January 2004" in text

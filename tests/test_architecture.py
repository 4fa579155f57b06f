"""What holds for the project as a whole."""

import ast
import os
import re
import subprocess
import sys
import tomllib
from collections import Counter
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
PACKAGE = ROOT / "kinesic"
ROOMS = (
    *("body", "files", "bml", "motion", "expressivity", "ik", "planning", "sim", "hardware", "face", "speech"),
    *(
        "intent",
        "controller",
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
    ),
)
LINKS = ("controller", "ik", "expressivity", "sim", "hardware", "configs")
MOST_LINES = 320
MOST_FILES = 22  # in a folder


def sources() -> list[Path]:
    """All Python files of the package, the tests and the examples."""
    return sorted(path for folder in ("kinesic", "tests", "examples") for path in (ROOT / folder).rglob("*.py"))


def test_imports_go_downwards_only():
    lint = Path(sys.executable).with_name("lint-imports")
    if not lint.exists():
        pytest.skip("import-linter is not installed")
    done = subprocess.run([lint, "--no-cache"], cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


def test_no_file_is_long():
    long = {str(path.relative_to(ROOT)): len(path.read_text(encoding="utf-8").splitlines()) for path in sources()}
    assert {name: lines for name, lines in long.items() if lines > MOST_LINES} == {}


def test_every_room_is_a_package_and_there_is_no_other():
    folders = {path.name for path in PACKAGE.iterdir() if path.is_dir() and path.name != "__pycache__"}
    assert folders == set(ROOMS)


def test_every_folder_with_code_is_a_package():
    folders = {path.parent for path in PACKAGE.rglob("*.py")}
    assert [str(folder.relative_to(ROOT)) for folder in sorted(folders) if not (folder / "__init__.py").exists()] == []


def test_a_folder_says_in_one_sentence_what_it_is_for():
    for init in sorted(PACKAGE.rglob("__init__.py")):
        said = ast.get_docstring(ast.parse(init.read_text(encoding="utf-8"))) or ""
        assert re.fullmatch(r"[^\n]+\.", said), (init, said)
        assert not re.search(r"\. [A-Z]", said), (init, said)


def test_no_folder_is_crowded():
    files = Counter(str(path.parent.relative_to(ROOT)) for path in PACKAGE.rglob("*.py"))
    assert {folder: count for folder, count in files.items() if count > MOST_FILES} == {}


@pytest.mark.parametrize("name", LINKS)
def test_the_root_shows_a_room_by_a_relative_link(name: str):
    link = ROOT / name
    if not link.is_symlink():
        pytest.skip("this checkout has no symbolic links")
    assert os.readlink(link) == f"kinesic/{name}"
    assert link.resolve() == PACKAGE / name


def test_tests_mirror_the_rooms():
    for room in set(ROOMS) - {"configs"}:
        assert next((ROOT / "tests" / room).rglob("test_*.py"), None), f"tests/{room} has no test"


def test_no_folder_of_tests_is_left_out():
    """A pattern without a slash that names a root link would also skip the folder of tests with this name."""
    options = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]
    skipped = {*options["pytest"]["ini_options"].get("norecursedirs", []), *options["ruff"].get("extend-exclude", [])}
    assert skipped.isdisjoint(ROOMS)


def test_the_license_is_apache_2():
    text = (ROOT / "LICENSE").read_text(encoding="utf-8")
    assert "Apache License" in text
    assert "Version 2.0, January 2004" in text

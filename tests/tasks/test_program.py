"""Version of a program, by its sources and libraries."""

import re
from pathlib import Path

import pytest

import kinesic
from kinesic.tasks import program


@pytest.fixture
def version_of(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """Return the version of a program with some files."""

    def of(**files: str) -> str:
        folder = tmp_path / str(len(list(tmp_path.iterdir())))
        folder.mkdir()
        for name, text in files.items():
            (folder / name.replace("_", ".")).write_text(text)
        monkeypatch.setattr(program, "PACKAGE_FOLDER", folder)
        return program.program_version.__wrapped__()

    return of


def test_program_version_depends_only_on_names_and_texts_of_source_files(version_of):
    version = version_of(a_py="text", b_txt="notes")
    assert version == version_of(a_py="text", b_txt="other notes")
    assert version != version_of(a_py="other text")
    assert version != version_of(c_py="text")


def test_program_version_contains_a_short_hash_and_versions_of_python_and_libraries(version_of):
    pattern = r"sources [0-9a-f]{12}, python 3\.\d+\.\d+\S*, numpy \S+, mujoco-core \S+, casadi \S+, highspy \S+"
    assert re.fullmatch(pattern, version_of(a_py=""))
    assert program._version("no-such-library") == "missing"


def test_program_files_come_from_the_folder_of_the_package():
    assert Path(kinesic.__file__).resolve().parent == program.PACKAGE_FOLDER
    assert Path(program.__file__).resolve() in program.program_files((".py",))


@pytest.mark.parametrize("suffix", ["py", "toml", "cpp", "h"])
def test_change_of_any_source_file_type_changes_the_program_version(version_of, suffix: str):
    assert version_of(**{f"a_{suffix}": "1"}) != version_of(**{f"a_{suffix}": "2"})
    assert version_of(**{f"a_{suffix}": "1"}) != version_of()


def test_program_files_include_subfolders_and_are_sorted_by_path(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(program, "PACKAGE_FOLDER", tmp_path)
    (tmp_path / "inner" / "deep").mkdir(parents=True)
    files = [tmp_path / name for name in ("a.py", "inner/b.py", "inner/deep/c.py", "z.py")]
    for file in reversed(files):
        file.touch()
    (tmp_path / "inner" / "notes.txt").touch()
    assert list(program.program_files((".py",))) == files


def test_program_files_exclude_packages_of_the_web_client(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(program, "PACKAGE_FOLDER", tmp_path)
    (tmp_path / "client" / "node_modules" / "gyp").mkdir(parents=True)
    (tmp_path / "client" / "node_modules" / "gyp" / "a.py").touch()
    (tmp_path / "client" / "b.py").touch()
    assert list(program.program_files((".py",))) == [tmp_path / "client" / "b.py"]


def test_program_version_is_independent_of_the_order_of_source_files(version_of):
    assert version_of(a_py="1", b_toml="2") == version_of(b_toml="2", a_py="1")
    assert version_of(a_py="1", b_py="2") != version_of(a_py="2", b_py="1")

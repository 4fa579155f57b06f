"""Version of a program, by its sources and libraries."""

import re
from pathlib import Path

import pytest

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


def test_version_depends_on_names_and_texts_of_sources_only(version_of):
    version = version_of(a_py="text", b_txt="notes")
    assert version == version_of(a_py="text", b_txt="other notes")
    assert version != version_of(a_py="other text")
    assert version != version_of(c_py="text")


def test_version_names_a_short_hash_python_and_libraries(version_of):
    pattern = r"sources [0-9a-f]{12}, python 3\.\d+\.\d+\S*, numpy \S+, mujoco-core \S+, casadi \S+, highspy \S+"
    assert re.fullmatch(pattern, version_of(a_py=""))
    assert program._version("no-such-library") == "missing"

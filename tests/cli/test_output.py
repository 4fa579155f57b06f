"""Protection of existing files and folders by all verbs that write."""

import os
from pathlib import Path

import pytest

from kinesic.files.output_folder import MARKER_FILE, MARKER_TEXT

FOLDER_VERBS = {
    "perform": ("perform", "nowhere.bml"),
    "validate": ("validate", "nowhere"),
    "sweep": ("sweep", "nowhere", "--parameter", "power"),
    "study": ("study", "make", "--size", "64"),
    "gesture study": ("study", "make-gestures", "--gesture", "nowhere"),
}
FILE_VERBS = {
    "plan.npz": ("plan", "nowhere.bml"),
    "plan.csv": ("plan", "nowhere.bml"),
    "plan.bap": ("plan", "nowhere.bml"),
    "plan.glb": ("plan", "nowhere.bml"),
    "face.png": ("face", "--bml", "nowhere.bml"),
    "sheet.png": ("face", "--sheet"),
    "gesture.png": ("gestures", "render", "nowhere"),
    "robot.toml": ("robots", "import", "nowhere.xml"),
    "twin.toml": ("twin", "fit", "nowhere.npz"),
}


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Home folder of the user, marked as if kinesic had made it."""
    home = tmp_path.parent / f"{tmp_path.name}-home"
    home.mkdir()
    (home / "letter").write_text("dear")
    (home / MARKER_FILE).write_bytes(MARKER_TEXT)
    monkeypatch.setenv("HOME", str(home))
    (tmp_path / "letter").write_text("dear")
    (tmp_path / "folder").mkdir()
    (tmp_path / "folder" / "letter").write_text("dear")
    (tmp_path / "to folder").symlink_to("folder")
    (tmp_path / "to home").symlink_to(home)
    (tmp_path / "to nothing").symlink_to("nothing")
    return home


@pytest.mark.parametrize("force", [False, True])
@pytest.mark.parametrize("verb", FOLDER_VERBS.values(), ids=FOLDER_VERBS)
def test_no_command_replaces_a_folder_not_written_by_kinesic(kinesic, tmp_path: Path, home: Path, verb, force: bool):
    for target in (home, "/", ".", "..", "folder", "letter", "letter/new", "to folder", "to home", "to nothing"):
        ended = kinesic(*verb, "--out", str(target), *(["--force"] if force else []))
        assert ended.code == 2, target
        assert ended.err.startswith(f"kinesic: {target}"), ended.err
        assert ended.err.count("\n") == 1
    assert sorted(os.listdir(tmp_path)) == ["folder", "letter", "to folder", "to home", "to nothing"]
    for letter in (home / "letter", tmp_path / "letter", tmp_path / "folder" / "letter"):
        assert letter.read_text() == "dear"


@pytest.mark.parametrize("force", [False, True])
@pytest.mark.parametrize(("name", "verb"), FILE_VERBS.items(), ids=FILE_VERBS)
def test_no_command_writes_through_a_link_or_replaces_a_file_without_force(
    kinesic, tmp_path: Path, home: Path, name, verb, force
):
    ending = Path(name).suffix
    letter, link, folder = (tmp_path / f"{kind}{ending}" for kind in ("letter", "link", "folder"))
    letter.write_text("dear")
    link.symlink_to(letter.name)
    folder.mkdir()
    for target in (link, folder, tmp_path / "nowhere" / name, *([] if force else [letter])):
        ended = kinesic(*verb, "--out", str(target), *(["--force"] if force else []))
        assert ended.code == 2
        assert ended.err.startswith(f"kinesic: {target}"), ended.err
        assert ended.err.count("\n") == 1
    assert letter.read_text() == "dear"
    assert link.is_symlink()
    assert not os.listdir(folder)


def test_benchmark_plots_are_replaced_only_with_force(kinesic, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    def draw(metrics: object, folder: Path) -> list[Path]:
        (folder / "ik-solver.png").write_text("new")
        return [folder / "ik-solver.png"]

    monkeypatch.setattr("kinesic.bench.ik.draw", draw)
    monkeypatch.setattr("kinesic.cli.bench.measure", lambda part, stage: [])
    assert kinesic("bench", "ik", "--plots", "docs").code == 0
    (tmp_path / "docs" / "ik-solver.png").write_text("dear")
    refused = kinesic("bench", "ik", "--plots", "docs")
    assert refused.code == 2
    assert "ik-solver.png exists already" in refused.err
    assert (tmp_path / "docs" / "ik-solver.png").read_text() == "dear"
    assert kinesic("bench", "ik", "--plots", "docs", "--force").code == 0
    assert (tmp_path / "docs" / "ik-solver.png").read_text() == "new"


def test_simulated_servo_port_with_the_name_of_an_existing_file_is_refused(kinesic, tmp_path: Path):
    (tmp_path / "body").write_text("dear")
    ended = kinesic("servos", "simulate", "--folder", ".")
    assert ended.code == 2
    assert ended.err == "kinesic: body: File exists\n"
    assert (tmp_path / "body").read_text() == "dear"

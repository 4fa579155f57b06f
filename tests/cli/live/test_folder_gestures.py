"""Loading of gesture files from a folder that clients can write to."""

from pathlib import Path

import pytest

from kinesic.cli.live import folder_gestures
from kinesic.cli.live.folder_gestures import read_folder

GESTURE_FILE = 'category = "beat"\n[[gesture]]\nid = "{}"\nkeys = [{{ right = {{ at = [0.5, 0.3, 0.5] }} }}]\n'


def write(folder: Path, name: str, id: str | None = None, *, size: int = 0) -> int:
    """Write a file with one gesture, and return its size."""
    text = GESTURE_FILE.format(id or name)
    (folder / f"{name}.toml").write_text(text + "#" * max(size - len(text), 0))
    return max(size, len(text))


def read_names(folder: Path) -> tuple[list[str], int]:
    """Return the names of a folder's gestures, and its number of faults."""
    result = read_folder(folder)
    return [form.id for part in result.parts for form, _ in part.entries], len(result.faults)


def test_gesture_files_of_a_folder_are_read_in_alphabetical_order(tmp_path: Path) -> None:
    for name in ("c", "a", "b"):
        write(tmp_path, name)
    (tmp_path / "style.toml").write_text('[style]\nname = "x"\n')
    (tmp_path / "other.txt").write_text(GESTURE_FILE.format("other"))
    assert read_names(tmp_path) == (["a", "b", "c"], 0)
    assert read_names(tmp_path / "missing") == ([], 0)


def test_symlinks_and_subfolders_in_a_gesture_folder_are_skipped(tmp_path: Path) -> None:
    folder = tmp_path / "gestures"
    folder.mkdir()
    write(tmp_path, "outside")
    (folder / "link.toml").symlink_to(tmp_path / "outside.toml")
    (folder / "folder.toml").mkdir()
    write(folder, "own")
    assert read_names(folder) == (["own"], 0)


def test_invalid_gesture_files_are_reported_and_valid_ones_read(tmp_path: Path) -> None:
    write(tmp_path, "b")
    (tmp_path / "a.toml").write_text("gesture = [")
    (tmp_path / "c.toml").write_text('[[gesture]]\nid = "c"\nkeys = 3\n')
    names, faults = read_names(tmp_path)
    assert names == ["b"]
    assert faults == 2
    assert all(str(tmp_path) in fault for fault in read_folder(tmp_path).faults)


def test_total_size_of_the_gesture_files_in_a_folder_is_limited(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    total = write(tmp_path, "a", size=300) + write(tmp_path, "b", size=400)
    write(tmp_path, "c", size=200)
    monkeypatch.setattr(folder_gestures, "MAX_GESTURE_BYTES", total)
    assert read_names(tmp_path) == (["a", "b"], 1)
    monkeypatch.setattr(folder_gestures, "MAX_GESTURE_BYTES", total - 1)
    assert read_names(tmp_path) == (["a", "c"], 1), "a smaller one still fits"


def test_number_of_gesture_files_in_a_folder_is_limited(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("a", "b", "c"):
        write(tmp_path, name)
    monkeypatch.setattr(folder_gestures, "MAX_GESTURE_FILES", 2)
    assert len(read_names(tmp_path)[0]) == 2

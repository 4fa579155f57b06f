"""Output replaces only files and folders made by kinesic."""

import os
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from tempfile import TemporaryDirectory
from threading import Event, Thread

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kinesic.body.config import ConfigError
from kinesic.files.output_file import new_file
from kinesic.files.output_folder import MARKER_FILE, MARKER_TEXT, new_folder

ITEM_NAMES = ("a", "b", "c")
# kinds of items below the root, among them links upwards and to the home folder
ITEM_KINDS = (
    "file",
    "folder",
    "marked",
    "link",
    "way up",
    "home link",
)  # kinds of items below the root, including links upwards and to the home folder
ITEM_PATHS = st.lists(st.sampled_from(ITEM_NAMES), min_size=1, max_size=3)
FOLDER_TREES = st.lists(st.tuples(ITEM_PATHS, st.sampled_from(ITEM_KINDS), ITEM_PATHS), max_size=8)
SWAP_COUNT = 150  # number of writes while items are swapped


@pytest.fixture(scope="module", autouse=True)
def _away_from_home() -> Iterator[None]:
    """Use a temporary home and working folder."""
    with TemporaryDirectory() as place, pytest.MonkeyPatch.context() as patch:
        patch.setenv("HOME", place)
        patch.chdir(place)
        yield


def grow(root: Path, tree: list[tuple[list[str], str, list[str]]]) -> None:
    """Create files, folders, marked folders and links below a root."""
    for names, kind, way in tree:
        path = root.joinpath(*names)
        with suppress(OSError):
            match kind:
                case "file":
                    path.write_text("dear")
                case "link":
                    path.symlink_to(root.joinpath(*way))
                case "way up":
                    path.symlink_to("..")
                case "home link":
                    path.symlink_to(Path.home())
                case _:
                    path.mkdir(parents=True)
                    (path / "letter").write_text("dear")
                    if kind == "marked":
                        (path / MARKER_FILE).write_bytes(MARKER_TEXT)


def letters(root: Path) -> set[str]:
    """Return the content of all user files outside marked folders."""
    results = set()
    for folder, folders, files in os.walk(root):
        if MARKER_FILE in files:
            folders.clear()
            continue
        results |= {os.path.join(folder, name) for name in (*folders, *files)}
    return {name for name in results if not (Path(name) / MARKER_FILE).exists() or Path(name).is_symlink()}


@given(FOLDER_TREES, ITEM_PATHS, st.booleans(), st.booleans())
def test_output_folder_replaces_only_marked_or_empty_folders(tree, names, force, fails):
    with TemporaryDirectory() as place:
        grow(Path(place), tree)
        target, before = Path(place).joinpath(*names), letters(Path(place))
        leads_to = Path(os.path.realpath(target))  # Partly resolved if links are circular
        inside_a_marked = any((folder / MARKER_FILE).exists() for folder in leads_to.parents)
        with suppress(ConfigError, ZeroDivisionError), new_folder(target, force=force) as fresh:
            (fresh / "result").write_text("new")
            if fails:
                raise ZeroDivisionError
        gone = before - letters(Path(place))
        assert gone <= {os.path.realpath(target)}  # An empty folder that is marked now
        assert not gone or (target / MARKER_FILE).read_bytes() == MARKER_TEXT or inside_a_marked
        assert not [name for name in letters(Path(place)) if "/." in name.removeprefix(place)]


@given(FOLDER_TREES, ITEM_PATHS, st.booleans())
def test_output_file_deletes_no_path_and_overwrites_no_existing_file_without_force(tree, names, force):
    with TemporaryDirectory() as place:
        grow(Path(place), tree)
        target, before = Path(place).joinpath(*names), letters(Path(place))
        was = target.read_text() if target.is_file() else None
        with suppress(ConfigError), new_file(target, force=force) as fresh:
            fresh.write_text("new")
        assert letters(Path(place)) >= before
        if was is not None and not force:
            assert target.read_text() == was


def swap(target: Path, mine: Path, done: Event) -> None:
    """Replace a marked folder by other items in a tight loop."""
    away = target.with_name("away")
    while not done.is_set():
        with suppress(OSError):
            target.rename(away)
            target.symlink_to(mine)
            target.unlink()
            mine.rename(target)
            target.rename(mine)
            away.rename(target)
        with suppress(OSError):  # The target was replaced during the race: start again
            if target.is_symlink():
                target.unlink()
            if (target / "letter").exists() and not mine.exists():
                target.rename(mine)


@pytest.mark.soak
def test_concurrent_folder_swaps_delete_no_user_file(tmp_path: Path):
    target, mine, done = tmp_path / "out" / "demo", tmp_path / "mine", Event()
    mine.mkdir()
    for k in range(20):
        (mine / f"letter{k}").write_text("dear")
    (mine / "letter").write_text("dear")
    with new_folder(target):
        pass
    thread = Thread(target=swap, args=(target, mine, done))
    thread.start()
    replaced = 0
    try:
        for _ in range(SWAP_COUNT):
            with suppress(ConfigError), new_folder(target, force=True) as fresh:
                (fresh / "result").write_text("new")
                replaced += 1
    finally:
        done.set()
        thread.join()
    kept = [path for path in tmp_path.rglob("letter*") if path.read_text() == "dear"]
    assert len(kept) == 21
    assert len({path.parent for path in kept}) == 1
    assert replaced > 0

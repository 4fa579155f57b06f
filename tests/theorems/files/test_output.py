"""Whatever stands at a path, and whoever moves it meanwhile: nothing is replaced but what kinesic has made."""

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
from kinesic.files.output_folder import MARK, MARKER, new_folder

NAMES = ("a", "b", "c")
KINDS = ("file", "folder", "marked", "link", "way up", "home link")
PATHS = st.lists(st.sampled_from(NAMES), min_size=1, max_size=3)
TREES = st.lists(st.tuples(PATHS, st.sampled_from(KINDS), PATHS), max_size=8)
SWAPS = 150


@pytest.fixture(scope="module", autouse=True)
def _away_from_home() -> Iterator[None]:
    """A home and a working folder of one's own."""
    with TemporaryDirectory() as place, pytest.MonkeyPatch.context() as patch:
        patch.setenv("HOME", place)
        patch.chdir(place)
        yield


def grow(root: Path, tree: list[tuple[list[str], str, list[str]]]) -> None:
    """Makes files, folders, marked ones and links below a root."""
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
                        (path / MARKER).write_bytes(MARK)


def letters(root: Path) -> set[str]:
    """Everything that is in no marked folder; links as what they are."""
    found = set()
    for folder, folders, files in os.walk(root):
        if MARKER in files:
            folders.clear()
            continue
        found |= {os.path.join(folder, name) for name in (*folders, *files)}
    return {name for name in found if not (Path(name) / MARKER).exists() or Path(name).is_symlink()}


@given(TREES, PATHS, st.booleans(), st.booleans())
def test_a_folder_takes_no_place_but_that_of_a_marked_or_empty_one(tree, names, force, fails):
    with TemporaryDirectory() as place:
        grow(Path(place), tree)
        target, before = Path(place).joinpath(*names), letters(Path(place))
        leads_to = Path(os.path.realpath(target))  # as far as links lead, if they go in a circle
        inside_a_marked = any((folder / MARKER).exists() for folder in leads_to.parents)
        with suppress(ConfigError, ZeroDivisionError), new_folder(target, force=force) as fresh:
            (fresh / "result").write_text("new")
            if fails:
                raise ZeroDivisionError
        gone = before - letters(Path(place))
        assert gone <= {os.path.realpath(target)}  # an empty folder that is a marked one now
        assert not gone or (target / MARKER).read_bytes() == MARK or inside_a_marked
        assert not [name for name in letters(Path(place)) if "/." in name.removeprefix(place)]


@given(TREES, PATHS, st.booleans())
def test_a_file_takes_no_place_but_that_of_a_file_and_only_if_forced(tree, names, force):
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
    """Exchanges a marked folder for a link, a folder of somebody's and a file, and back, as fast as it can."""
    away = target.with_name("away")
    while not done.is_set():
        with suppress(OSError):
            target.rename(away)
            target.symlink_to(mine)
            target.unlink()
            mine.rename(target)
            target.rename(mine)
            away.rename(target)
        with suppress(OSError):  # where the other one was in between: a new beginning
            if target.is_symlink():
                target.unlink()
            if (target / "letter").exists() and not mine.exists():
                target.rename(mine)


def test_a_thread_that_swaps_the_folder_meanwhile_costs_nobody_a_file(tmp_path: Path):
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
        for _ in range(SWAPS):
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

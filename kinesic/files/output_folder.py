"""Writes folders as wholes, in place of nothing but folders that kinesic has made: these hold a file that says so.

Everything is checked of a folder that is held open, and only what was checked is emptied: a link that takes its name
meanwhile leads nowhere.
"""

import os
import pwd
import stat
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path

from kinesic.body.config import ConfigError
from kinesic.files.draft import PUBLIC_MODE, hold_draft, is_same, mark_as_abandoned, remove_folder
from kinesic.files.held_folder import check_above, find_place, hold_folder, name_beside, name_failures

MARKER = ".kinesic"
MARK = b"kinesic made this folder; with --force it replaces the folder and everything in it.\n"


def check_folder(folder: Path, *, force: bool = False) -> None:
    """Refuses a folder that `new_folder` would not write, before any work is done for it.

    Args:
        folder: that is to be written.
        force: whether a folder that kinesic has made may be replaced.

    Raises:
        ConfigError: something is there that must stay, or nothing can be written there.
    """
    place = find_place(folder)
    check_above(place, folder)
    if place.parent.exists():
        with name_failures(folder), ExitStack() as held:
            parent = held.enter_context(hold_folder(place.parent))
            held.enter_context(_hold_replaceable(place.name or ".", folder, parent=parent, force=force))


@contextmanager
def new_folder(folder: Path, *, force: bool = False) -> Iterator[Path]:
    """Yields a marked folder beside to write to; it takes its place when all went well, else nothing has changed.

    Args:
        folder: that is to be written; an empty one may be there.
        force: whether a folder that kinesic has made may be replaced.

    Raises:
        ConfigError: as `check_folder`, or it could not be written.
    """
    check_folder(folder, force=force)
    place = find_place(folder)
    with name_failures(folder), _folders_above(place), ExitStack() as held:
        parent = held.enter_context(hold_folder(place.parent))
        draft = held.enter_context(hold_draft(place.name, parent=parent, mode=PUBLIC_MODE))
        _mark(draft.folder)
        with _naming(folder, place.parent / draft.name):
            yield place.parent / draft.name
        earlier = held.enter_context(_hold_replaceable(place.name, folder, parent=parent, force=force))
        aside = _put_aside(place.name, earlier, folder, parent=parent) if earlier is not None else None
        try:
            draft.finish()
            os.rename(draft.name, place.name, src_dir_fd=parent, dst_dir_fd=parent)  # fails unless it is free or empty
        except BaseException:
            if aside is not None:
                _put_back(aside, place.name, folder, parent=parent)
            raise
        if aside is not None and earlier is not None:
            mark_as_abandoned(earlier)
            remove_folder(aside, earlier, parent=parent)


def is_made(folder: Path) -> bool:
    """Says whether kinesic has made a folder; of a link, never."""
    with suppress(OSError), hold_folder(folder) as held:
        return _is_marked(held)
    return False


@contextmanager
def _folders_above(place: Path) -> Iterator[None]:
    """Makes the folders above a place; when what follows fails, those that are new go again while they are empty."""
    missing = [above for above in place.parents if not above.exists()]
    try:
        place.parent.mkdir(parents=True, exist_ok=True)
        yield
    except BaseException:
        with suppress(OSError):
            for above in missing:
                above.rmdir()
        raise


@contextmanager
def _naming(folder: Path, fresh: Path) -> Iterator[None]:
    """Lets what could not be written to a fresh folder be told of the folder whose place it would have taken."""
    try:
        yield
    except ConfigError as error:
        raise ConfigError(str(error).replace(str(fresh), str(folder))) from None


def _put_aside(name: str, held: int, folder: Path, *, parent: int) -> str:
    """Renames the folder that is held open; returns its hidden name.

    Raises:
        ConfigError: something else has its name by now; that is left as it is.
    """
    aside = name_beside(name)
    os.rename(name, aside, src_dir_fd=parent, dst_dir_fd=parent)
    if not is_same(aside, held, parent=parent):
        _put_back(aside, name, folder, parent=parent)
        raise ConfigError(f"{folder} was exchanged meanwhile; nothing is replaced")
    return aside


def _put_back(aside: str, name: str, folder: Path, *, parent: int) -> None:
    """Gives something its name again, unless that is taken: a folder takes the place of none, and a link of nothing."""
    try:
        if stat.S_ISDIR(os.stat(aside, dir_fd=parent, follow_symlinks=False).st_mode):
            os.rename(aside, name, src_dir_fd=parent, dst_dir_fd=parent)
        else:
            os.link(aside, name, src_dir_fd=parent, dst_dir_fd=parent, follow_symlinks=False)
            os.unlink(aside, dir_fd=parent)
    except OSError:
        raise ConfigError(f"{folder} was taken meanwhile; what was there is kept beside it as {aside}") from None


@contextmanager
def _hold_replaceable(name: str, folder: Path, *, parent: int, force: bool) -> Iterator[int | None]:
    """Holds the folder that would be replaced; None where nothing is there, or nothing is in it.

    Raises:
        ConfigError: it must stay.
    """
    with ExitStack() as held:
        try:
            mode = os.stat(name, dir_fd=parent, follow_symlinks=False).st_mode
            if stat.S_ISLNK(mode):
                raise ConfigError(f"{folder} is a link, and links are never followed; name the folder itself")
            if not stat.S_ISDIR(mode):
                raise ConfigError(f"{folder} is a file, and a folder is to be written; name another")
            earlier = held.enter_context(hold_folder(name, inside=parent))
        except FileNotFoundError:
            yield None
            return
        found = os.fstat(earlier)
        if any(os.path.samestat(found, kept) for kept in _kept()):
            raise ConfigError(f"{folder} is the home or working folder, or holds it, and is never replaced")
        if not os.listdir(earlier):
            yield None
            return
        if not force:
            raise ConfigError(f"{folder} exists already; --force replaces it, --out names another")
        if not _is_marked(earlier):
            raise ConfigError(
                f"{folder} exists already and is not marked as kinesic's own ({MARKER}), so that --force leaves it as "
                "it is; remove it yourself, or name another folder"
            )
        yield earlier


def _kept() -> Iterator[os.stat_result]:
    """Yields the home folder, the working folder, and all folders above them, up to the root."""
    for find in (Path.home, lambda: Path(pwd.getpwuid(os.getuid()).pw_dir), Path.cwd):
        with suppress(OSError, RuntimeError, KeyError):
            place = find().resolve()
            for folder in (place, *place.parents):
                yield folder.stat()


def _mark(folder: int) -> None:
    with open(os.open(MARKER, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o666, dir_fd=folder), "wb") as file:
        file.write(MARK)


def _is_marked(folder: int) -> bool:
    """Says whether an open folder holds the mark: a file with the very words, no link and no pipe."""
    try:
        descriptor = os.open(MARKER, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK, dir_fd=folder)
    except OSError:
        return False
    with open(descriptor, "rb") as file:
        return stat.S_ISREG(os.fstat(descriptor).st_mode) and file.read(len(MARK) + 1) == MARK

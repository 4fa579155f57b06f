"""Atomic folder writing that replaces only folders made by kinesic.

Such folders contain a marker file. All checks are made on a folder that is held open, and only the checked folder is
emptied: a link that takes its name meanwhile leads nowhere.
"""

import os
import stat
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path

from kinesic.body.config import ConfigError
from kinesic.files.draft import PUBLIC_MODE, hold_draft, is_same, mark_as_abandoned, remove_folder
from kinesic.files.held_folder import HeldFolder, check_above, find_place, hold_folder, name_beside, name_failures
from kinesic.host import NO_LINK_FLAG, NO_WAIT_FLAG, account_home, user_id

MARKER_FILE = ".kinesic"  # name of the file that marks a folder as made by kinesic
# content of an output folder's marker file
MARKER_TEXT = b"kinesic made this folder; with --force it replaces the folder and everything in it.\n"


def check_folder(folder: Path, *, force: bool = False) -> None:
    """Raise an error if `new_folder` could not write a folder.

    Args:
        folder: folder to be written.
        force: whether an existing folder of kinesic may be replaced.

    Raises:
        ConfigError: the existing contents must stay, or the place is not writable.
    """
    place = find_place(folder)
    check_above(place, folder)
    if place.parent.exists():
        with name_failures(folder), ExitStack() as held:
            parent = held.enter_context(hold_folder(place.parent))
            held.enter_context(_hold_replaceable(place.name or ".", folder, parent=parent, force=force))


@contextmanager
def new_folder(folder: Path, *, force: bool = False) -> Iterator[Path]:
    """Yield a temporary folder, renamed to the final path on success.

    Args:
        folder: folder to be written; an empty one may exist.
        force: whether an existing folder of kinesic may be replaced.

    Raises:
        ConfigError: as `check_folder`, or writing failed.
    """
    check_folder(folder, force=force)
    place = find_place(folder)
    with name_failures(folder), _create_parents(place), ExitStack() as held:
        parent = held.enter_context(hold_folder(place.parent))
        draft = held.enter_context(hold_draft(place.name, parent=parent, mode=PUBLIC_MODE))
        _mark(draft.folder)
        with _rename_in_errors(folder, place.parent / draft.name):
            yield place.parent / draft.name
        earlier = held.enter_context(_hold_replaceable(place.name, folder, parent=parent, force=force))
        aside = _put_aside(place.name, earlier, folder, parent=parent) if earlier is not None else None
        try:
            draft.finish()
            parent.rename_entry(draft.name, place.name)  # fails if the name is taken by a non-empty folder
        except BaseException:
            if aside is not None:
                _put_back(aside, place.name, folder, parent=parent)
            raise
        if aside is not None and earlier is not None:
            mark_as_abandoned(earlier.renamed(aside))
            remove_folder(aside, earlier.renamed(aside), parent=parent)


def remove_made_folder(folder: Path) -> None:
    """Remove a folder that kinesic made, with its contents.

    Raises:
        ConfigError: the folder is missing, a link, or not made by kinesic.
    """
    place = find_place(folder)
    with name_failures(folder), ExitStack() as held:
        parent = held.enter_context(hold_folder(place.parent))
        earlier = held.enter_context(_hold_replaceable(place.name or ".", folder, parent=parent, force=True))
        if earlier is None:
            raise ConfigError(f"{folder}: there is no such folder, or it is empty")
        aside = _put_aside(place.name, earlier, folder, parent=parent)
        mark_as_abandoned(earlier.renamed(aside))
        remove_folder(aside, earlier.renamed(aside), parent=parent)


def is_made(folder: Path) -> bool:
    """Return whether a folder has kinesic's marker file.

    False for a link.
    """
    with suppress(OSError), hold_folder(folder) as held:
        return _is_marked(held)
    return False


@contextmanager
def _create_parents(place: Path) -> Iterator[None]:
    """Create missing parent folders, and remove them again after a failure."""
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
def _rename_in_errors(folder: Path, fresh: Path) -> Iterator[None]:
    """Name the final path instead of the draft in error messages."""
    try:
        yield
    except ConfigError as error:
        raise ConfigError(str(error).replace(str(fresh), str(folder))) from None


def _put_aside(name: str, held: HeldFolder, folder: Path, *, parent: HeldFolder) -> str:
    """Rename an open folder to a hidden name, and return the name.

    Raises:
        ConfigError: another folder has its name by now, and is left as it is.
    """
    aside = name_beside(name)
    parent.rename_entry(name, aside)
    if not is_same(aside, held.renamed(aside), parent=parent):
        _put_back(aside, name, folder, parent=parent)
        raise ConfigError(f"{folder} was replaced by another program meanwhile and is left as it is")
    return aside


def _put_back(aside: str, name: str, folder: Path, *, parent: HeldFolder) -> None:
    """Restore a folder's or file's earlier name, unless the name is taken."""
    try:
        if stat.S_ISDIR(parent.entry_status(aside).st_mode):
            parent.rename_entry(aside, name)
        else:
            os.link(
                parent.entry_path(aside),
                parent.entry_path(name),
                src_dir_fd=parent.descriptor,
                dst_dir_fd=parent.descriptor,
                follow_symlinks=os.link not in os.supports_follow_symlinks,
            )
            parent.remove_entry(aside)
    except OSError:
        raise ConfigError(
            f"{folder} was created by another program meanwhile; the earlier content is kept next to it as {aside}"
        ) from None


@contextmanager
def _hold_replaceable(name: str, folder: Path, *, parent: HeldFolder, force: bool) -> Iterator[HeldFolder | None]:
    """Yield the opened folder to be replaced, or None without a folder.

    None if the folder is missing or empty.

    Raises:
        ConfigError: the folder must stay.
    """
    with ExitStack() as held:
        try:
            mode = parent.entry_status(name).st_mode
            if stat.S_ISLNK(mode):
                raise ConfigError(f"{folder} is a link, and links are never followed; name the folder itself")
            if not stat.S_ISDIR(mode):
                raise ConfigError(f"{folder} is a file, and a folder is to be written; name another")
            earlier = held.enter_context(hold_folder(name, inside=parent))
        except FileNotFoundError:
            yield None
            return
        status = earlier.status()
        if any(os.path.samestat(status, kept) for kept in _list_protected_folders()):
            raise ConfigError(f"{folder} is the home or working folder, or holds it, and is never replaced")
        if not earlier.names():
            yield None
            return
        if not force:
            raise ConfigError(f"{folder} exists already; --force replaces it, --out names another")
        if not _is_marked(earlier):
            raise ConfigError(
                f"{folder} exists already and is not marked as kinesic's own ({MARKER_FILE}), so that --force leaves "
                "it as it is; remove it yourself, or name another folder"
            )
        yield earlier


def _list_protected_folders() -> Iterator[os.stat_result]:
    """Yield folders never to replace: home, working folder and their parents."""
    for find in (Path.home, lambda: account_home(user_id()) or Path.cwd(), Path.cwd):
        with suppress(OSError, RuntimeError, KeyError):
            place = find().resolve()
            for folder in (place, *place.parents):
                yield folder.stat()


def _mark(folder: HeldFolder) -> None:
    with open(folder.open_entry(MARKER_FILE, os.O_WRONLY | os.O_CREAT | os.O_EXCL), "wb") as file:
        file.write(MARKER_TEXT)


def _is_marked(folder: HeldFolder) -> bool:
    """Return whether an open folder has a valid marker file."""
    try:
        descriptor = folder.open_entry(MARKER_FILE, os.O_RDONLY | NO_LINK_FLAG | NO_WAIT_FLAG)
    except OSError:
        return False
    with open(descriptor, "rb") as file:
        return stat.S_ISREG(os.fstat(descriptor).st_mode) and file.read(len(MARKER_TEXT) + 1) == MARKER_TEXT

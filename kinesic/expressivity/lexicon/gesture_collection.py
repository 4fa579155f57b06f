"""Installation and removal of collections of gestures in a library folder.

A collection is a flat folder or zip of TOML files, motions (.npz) and a card. Foreign archives are read into memory
under limits, and only their plain file names become paths.
"""

import re
import stat
import zlib
from collections.abc import Iterator, Mapping
from pathlib import Path, PurePosixPath
from zipfile import ZIP_DEFLATED, ZIP_STORED, BadZipFile, ZipFile, ZipInfo

from kinesic.body.config import ConfigError
from kinesic.expressivity.lexicon.captured_gesture import CARD_FILE
from kinesic.expressivity.lexicon.gesture_card import GestureCard, read_card
from kinesic.expressivity.lexicon.gesture_motion import MAX_MOTION_FILE_SIZE
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.files.input_file import open_regular, read_inside
from kinesic.files.output_folder import MARKER_FILE, new_folder, remove_made_folder
from kinesic.files.plain_name import is_device_name, plain_stem

MAX_ARCHIVE_SIZE = 200_000_000  # [bytes] largest collection, packed and unpacked
MAX_FILES = 5000  # largest number of files in a collection
ENCRYPTED_FLAG = 1  # flag of an encrypted zip entry

_FILE_NAME = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_-]{0,79}\.(toml|npz)|(LICEN[CS]E|NOTICE|README)(\.txt|\.md)?")


def find_collections(library: Path) -> tuple[Path, ...]:
    """Return the folders of a library that have a card.

    The library may be a single collection itself.

    Raises:
        ConfigError: there is no collection.
    """
    if (library / CARD_FILE).is_file():
        return (library,)
    folders = sorted(path.parent for path in library.glob(f"*/{CARD_FILE}") if path.is_file())
    if not folders:
        raise ConfigError(
            f"{library}: no collection of gestures; `kinesic capture import` and `kinesic gestures install` make one"
        )
    return tuple(folders)


def install_collection(source: Path, library: Path, *, force: bool = False) -> tuple[Path, GestureCard, int]:
    """Copy a collection of gestures into a library, after reading all gestures.

    Args:
        source: folder or .zip file of the collection.
        library: folder that holds collections; created if missing.
        force: whether an installed collection of the same name may be replaced.

    Returns:
        The folder of the collection, its card, and the number of its gestures.

    Raises:
        ConfigError: the archive is damaged or hostile, a file is invalid, or the card is missing.
    """
    files = _read_folder(source) if source.is_dir() else _read_archive(source)
    if CARD_FILE not in files:
        raise ConfigError(f"{source}: it has no {CARD_FILE} with name, licence and source")
    name = _card_name(files[CARD_FILE], source)
    folder = library / name
    with new_folder(folder, force=force) as fresh:
        for file, data in files.items():
            (fresh / file).write_bytes(data)
        card = read_card(fresh)
        count = len(Lexicon.load(fresh).entries) - len(Lexicon.load().entries)
        if not count:
            raise ConfigError(f"{source}: it has no gestures")
    return folder, card, count


def remove_collection(name: str, library: Path) -> Path:
    """Remove a collection from a library, and return its folder.

    Raises:
        ConfigError: the library has no such collection, or kinesic did not make its folder.
    """
    folders = {folder.name: folder for folder in find_collections(library) if folder != library}
    if name not in folders:
        raise ConfigError(f"{library}: no collection {name!r}; it has {', '.join(folders) or 'none'}")
    remove_made_folder(folders[name])
    return folders[name]


def _card_name(data: bytes, source: Path) -> str:
    """Return a collection's folder name, from the name in its card."""
    match = re.search(r'^name\s*=\s*"([^"]*)"', data.decode("utf-8", "replace"), re.MULTILINE)
    if match is None:
        raise ConfigError(f"{source}: {CARD_FILE} has no name")
    return plain_stem(match[1], fallback="gestures")


def _read_folder(source: Path) -> Mapping[str, bytes]:
    files: dict[str, bytes] = {}
    size = 0
    for path in sorted(source.iterdir()):
        if not _FILE_NAME.fullmatch(path.name):
            continue
        _check_count(len(files), size, source)
        try:
            files[path.name] = read_inside(source, path, max_size=MAX_MOTION_FILE_SIZE)
        except OSError as error:
            raise ConfigError(f"{path}: {error.strerror or error}") from None
        size += len(files[path.name])
    _check_count(len(files), size, source)
    return files


def _read_archive(source: Path) -> Mapping[str, bytes]:
    """Read the files of a zip archive, limited in size and number.

    The marker file of a folder that kinesic made is ignored.

    Raises:
        ConfigError: an entry leaves the folder, is a link, encrypted or too large, or has an unexpected name.
    """
    try:
        with open_regular(source) as file, ZipFile(file) as archive:
            entries = [
                entry
                for entry in archive.infolist()
                if not entry.is_dir() and PurePosixPath(entry.filename).name != MARKER_FILE
            ]
            _check_count(len(entries) - 1, sum(entry.file_size for entry in entries), source)
            return dict(_unpack(archive, entries, source))
    except OSError as error:
        raise ConfigError(f"{source}: {error.strerror or error}") from None
    except (BadZipFile, zlib.error, EOFError, NotImplementedError, ValueError, RuntimeError) as error:
        raise ConfigError(f"{source}: no valid .zip archive ({error})") from None


def _unpack(archive: ZipFile, entries: list[ZipInfo], source: Path) -> Iterator[tuple[str, bytes]]:
    names = set[str]()
    tops = {PurePosixPath(entry.filename).parts[:-1] for entry in entries}
    if len(tops) > 1 or any(len(top) > 1 for top in tops):
        raise ConfigError(f"{source}: its files must lie in one folder")
    for entry in entries:
        name = PurePosixPath(entry.filename).name
        is_odd = ".." in entry.filename or entry.filename.startswith("/") or "\\" in entry.filename
        if is_odd or not _FILE_NAME.fullmatch(name) or is_device_name(name):
            raise ConfigError(
                f"{source}: unexpected file {entry.filename[:60]!r}; only .toml, .npz and licences are read"
            )
        if name.lower() in names:
            raise ConfigError(f"{source}: two files are named {name}")
        if stat.S_ISLNK(entry.external_attr >> 16):
            raise ConfigError(f"{source}: {name} is a link")
        if entry.flag_bits & ENCRYPTED_FLAG or entry.compress_type not in (ZIP_STORED, ZIP_DEFLATED):
            raise ConfigError(f"{source}: {name} is encrypted or packed by another method than deflate")
        if entry.file_size > MAX_MOTION_FILE_SIZE:
            raise ConfigError(f"{source}: {name} has {entry.file_size} bytes; at most {MAX_MOTION_FILE_SIZE} are read")
        with archive.open(entry) as file:
            data = file.read(MAX_MOTION_FILE_SIZE + 1)
        if len(data) != entry.file_size:
            raise ConfigError(f"{source}: {name} unpacks to another size than stated")
        names.add(name.lower())
        yield name, data


def _check_count(count: int, size: int, source: Path) -> None:
    if count >= MAX_FILES or size > MAX_ARCHIVE_SIZE:
        raise ConfigError(f"{source}: a collection has at most {MAX_FILES} files and {MAX_ARCHIVE_SIZE / 1e6:.0f} MB")

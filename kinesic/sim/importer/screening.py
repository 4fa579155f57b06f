"""Screens a stranger's MJCF or URDF before anything is made of it: what it reads, and how much it makes."""

from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from xml.parsers import expat

from kinesic.body.config import ConfigError

LARGEST_MODEL = 20_000_000  # [bytes] of all files together
ELEMENTS = 100_000  # of all files together
DEEPEST = 200  # elements inside one another
FILES = 50
COPIES = 200  # that <replicate> may make
BODIES, GEOMS = 2000, 20_000
READS = ("include", "model")  # elements whose file is read as a part of the robot
GROWS = ("flexcomp", "composite")  # elements that MuJoCo makes many of


def screen_model(path: Path) -> None:
    """Refuses a file that reads outside its folder, or that would grow beyond any robot.

    Meshes and textures count for nothing here: they are never opened.

    Raises:
        ConfigError: it does; says what would have worked.
        xml.parsers.expat.ExpatError: a file is not well-formed.
        OSError: a file cannot be read.
    """
    folder = path.parent.resolve()
    pending, seen, sizes, elements = [path], {path.resolve()}, 0, 0
    while pending:
        file = pending.pop()
        with file.open("rb") as stream:
            data = stream.read(LARGEST_MODEL + 1 - sizes)
        sizes += len(data)
        if sizes > LARGEST_MODEL:
            raise ConfigError(f"{path}: more than {LARGEST_MODEL // 1_000_000} MB of XML; a robot's is below 1 MB")
        found = _Elements(file, ELEMENTS - elements)
        found.parser.Parse(data, True)
        elements += found.count
        for named in found.reads:
            fresh = [part for part in _parts(named, file, folder) if part.resolve() not in seen]
            pending += fresh
            seen |= {part.resolve() for part in fresh}
        if len(seen) > FILES:
            raise ConfigError(f"{path}: consists of more than {FILES} files")


def _parts(name: str, file: Path, folder: Path) -> Iterator[Path]:
    """Yields what a name may lead to: MuJoCo looks beside the first file, and beside the one that names it."""
    for start in {folder, file.parent.resolve()}:
        part = start / name
        if Path(name).is_absolute() or not part.resolve().is_relative_to(folder):
            raise ConfigError(f"{file}: reads {name}, outside of the robot's folder; copy that file beside it")
        if part.is_file():
            yield part


class _Elements:
    """What expat finds in one file."""

    def __init__(self, file: Path, most: int) -> None:
        self.count, self.reads = 0, list[str]()
        self._file, self._most, self._open = file, most, list[int]()  # copies at each depth
        self.parser = expat.ParserCreate()
        self.parser.StartDoctypeDeclHandler = self._refuse_doctype
        self.parser.StartElementHandler = self._begin
        self.parser.EndElementHandler = self._end

    def _begin(self, tag: str, attributes: dict[str, str]) -> None:
        self.count += 1
        if self.count > self._most:
            self._refuse(f"more than {ELEMENTS} elements")
        copies = self._open[-1] if self._open else 1
        if tag == "replicate":
            with suppress(ValueError, OverflowError):  # MuJoCo refuses what is no number
                copies *= max(int(float(attributes.get("count", "1"))), 1)
        if copies > COPIES:
            self._refuse(f"<replicate> makes {copies} copies, at most {COPIES} are taken")
        self._open.append(copies)
        if len(self._open) > DEEPEST:
            self._refuse(f"elements are inside one another more than {DEEPEST} deep")
        if tag in GROWS:
            self._refuse(f"holds a <{tag}>, which no robot's limb is; leave it out")
        if tag in READS and "file" in attributes:
            self.reads.append(attributes["file"])

    def _end(self, _tag: str) -> None:
        self._open.pop()

    def _refuse_doctype(self, *_declared: object) -> None:
        self._refuse("declares a document type, which may hold entities; leave it out")

    def _refuse(self, why: str) -> None:
        raise ConfigError(f"{self._file}:{self.parser.CurrentLineNumber}: {why}")

"""Parser of one model's XML, with its includes expanded."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import NoReturn
from xml.etree.ElementTree import Element, TreeBuilder
from xml.parsers import expat

from kinesic.body.config import ConfigError
from kinesic.sim.importer.reading.screening import (
    MAX_COPIES,
    MAX_DEPTH,
    MAX_ELEMENTS,
    MAX_INCLUDE_DEPTH,
    UnfitError,
    count_copies,
    is_unused,
    screen_element,
)

DOCTYPE_REASON = "declares a document type, which may hold entities; leave it out"


@dataclass(frozen=True)
class MeshReference:
    """Reference to a mesh file in a robot file."""

    file: str  # empty if the mesh has no file
    name: str
    below: str  # mesh folder of the <compiler> element


@dataclass(frozen=True)
class Attached:
    """Model attached by another model."""

    token: str  # placeholder for its file name
    count: int  # number of its elements, including copies


Read = Callable[
    [str, tuple[Path, ...], str], tuple[Path, bytes]
]  # (name, folders, position of the element) -> (path, data)
Attach = Callable[[str, tuple[Path, ...], str], Attached]


@dataclass(frozen=True)
class _Open:
    """XML element that the parser has not closed yet."""

    tag: str
    copies: int
    is_kept: bool


class ModelText:
    """Parser of one model's XML that screens each element."""

    def __init__(self, path: Path, read: Read, attach: Attach, tokens: Iterator[int]) -> None:
        """Prepare the parsing of one model, without any elements yet.

        Args:
            path: File of the model.
            read: Function that reads a referenced file.
            attach: Function that parses an attached model.
            tokens: Numbers of meshes, unique for all models of a robot.
        """
        self._path, self._read, self._attach, self._tokens = path, read, attach, tokens
        self._builder, self._open, self._line = TreeBuilder(), list[_Open](), 1
        self._elements, self._attachments, self._largest = 0, 0, 0
        self._included = {path.resolve()}
        self._below, self._include_depth = "", 0
        self._meshes: dict[tuple[str, str], str] = {}  # file and name -> token

    @property
    def count(self) -> int:
        """Number of elements, including copies and attached models."""
        return self._elements + self._attachments * self._largest

    def root(self) -> Element:
        """Return the root element after parsing."""
        return self._builder.close()

    def meshes(self) -> Mapping[str, MeshReference]:
        """Return the mesh references by placeholder token, after parsing."""
        return {token: MeshReference(file, name, self._below) for (file, name), token in self._meshes.items()}

    def parse(self, file: Path, data: bytes, *, is_included: bool = False) -> None:
        """Parse a model file, omitting the root element of an included file.

        Raises:
            ConfigError: the file has a document type, elements beyond the limits or an include that repeats.
            xml.parsers.expat.ExpatError: the file is not well-formed.
        """
        parser, depth = expat.ParserCreate(), 0

        def begin(tag: str, attributes: dict[str, str]) -> None:
            nonlocal depth
            depth += 1
            if is_included and depth == 1:
                return
            try:
                self._begin(tag, attributes, file, parser.CurrentLineNumber)
            except UnfitError as error:
                refuse(str(error))

        def end(_tag: str) -> None:
            nonlocal depth
            if not is_included or depth > 1:
                self._end()
            depth -= 1

        def refuse(why: str) -> NoReturn:
            raise ConfigError(f"{file}:{parser.CurrentLineNumber}: {why}") from None

        parser.StartDoctypeDeclHandler = lambda *_declared: refuse(DOCTYPE_REASON)
        parser.StartElementHandler, parser.EndElementHandler = begin, end
        parser.Parse(data, True)

    def _begin(self, tag: str, attributes: dict[str, str], file: Path, line: int) -> None:
        above = self._open[-1] if self._open else _Open("", 1, is_kept=True)
        if above.tag == "include":
            raise UnfitError("<include> holds elements; it must be empty")
        if len(self._open) >= MAX_DEPTH:
            raise UnfitError(f"elements are inside one another more than {MAX_DEPTH} deep")
        is_kept = above.is_kept and not self._is_unused(tag)
        kept = screen_element(tag, attributes) if is_kept else {}
        copies = above.copies
        if is_kept and tag == "replicate":
            count = count_copies(attributes)
            kept["count"], copies = str(count), copies * count
            if copies > MAX_COPIES:
                raise UnfitError(f"<replicate> makes {copies} copies, at most {MAX_COPIES} are taken")
        self._elements += copies
        self._attachments += copies if tag == "attach" else 0
        if is_kept:
            self._keep(tag, attributes, kept, file, line)
        if self.count > MAX_ELEMENTS:
            raise UnfitError(f"more than {MAX_ELEMENTS} elements, copies and attached models included")
        self._open.append(_Open(tag, copies, is_kept and tag != "include"))

    def _end(self) -> None:
        ended = self._open.pop()
        if ended.is_kept:
            self._builder.end(ended.tag)

    def _is_unused(self, tag: str) -> bool:
        above = [opened.tag for opened in self._open]
        return is_unused(tag, above[1:] if above[:2] == ["robot", "mujoco"] else above)

    def _keep(self, tag: str, attributes: dict[str, str], kept: dict[str, str], file: Path, line: int) -> None:
        """Copy an element with placeholders for file names, or expand an include."""
        starts, named_at = (self._path.parent, file.parent), f"{file}:{line}"
        name, above = attributes.get("file", ""), self._open[-1].tag if self._open else ""
        kept = {key: value for key, value in kept.items() if not key.startswith("file")}
        if tag == "include":
            self._include(name, starts, named_at)
            return
        if tag == "compiler":
            below = attributes.get("meshdir", attributes.get("assetdir", self._below))
            self._below = below.replace("\\", "/")
        elif tag == "mesh" and above == "asset":
            called = attributes.get("name") or PurePosixPath(name.replace("\\", "/")).stem
            kept |= {"name": called, "file": self._token(name, called)}
        elif tag == "mesh" and above != "default":  # a mesh element of a URDF
            kept["filename"] = self._token(attributes.get("filename", ""), "")
        elif tag == "model" and name:
            attached = self._attach(name, starts, named_at)
            self._largest, kept["file"] = max(self._largest, attached.count), attached.token
        if self._open and file == self._path:  # keeps the line numbers of MuJoCo's messages correct
            self._builder.data("\n" * (line - self._line))
            self._line = max(line, self._line)
        self._builder.start(tag, kept)

    def _include(self, name: str, starts: tuple[Path, ...], named_at: str) -> None:
        if not name:
            raise UnfitError("<include> names no file")
        place, data = self._read(name, starts, named_at)
        if place in self._included:
            raise ConfigError(f"{named_at}: includes {name} again; a file is included once")
        if self._include_depth >= MAX_INCLUDE_DEPTH:
            raise UnfitError(f"includes are inside one another more than {MAX_INCLUDE_DEPTH} deep")
        self._included.add(place)
        self._include_depth += 1
        self.parse(place, data, is_included=True)
        self._include_depth -= 1

    def _token(self, file: str, name: str) -> str:
        """Return the placeholder token of a mesh, one per file and name."""
        if (file, name) not in self._meshes:
            self._meshes[file, name] = f"mesh-{next(self._tokens)}.stl"
        return self._meshes[file, name]

"""Reader of a foreign robot's MJCF or URDF as self-contained XML.

MuJoCo opens files by rules of its own. It therefore gets text alone: includes are expanded here, attached models are
handed over as bytes, and meshes have tokens in place of their files.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from itertools import count
from pathlib import Path, PureWindowsPath
from xml.etree.ElementTree import Element, tostring

from kinesic.body.config import ConfigError
from kinesic.files.input_file import open_regular, read_inside
from kinesic.sim.importer.reading.file_kinds import refuse_other_kinds, refuse_other_roots
from kinesic.sim.importer.reading.model_text import Attached, MeshReference, ModelText
from kinesic.sim.importer.reading.xacro_file import expand_xacro, is_xacro

MAX_MODEL_SIZE = 20_000_000  # [bytes] largest total size of a robot's XML files
MAX_FILES = 500  # largest number of XML files of one robot


@dataclass(frozen=True, eq=False)
class RobotFiles:
    """Parsed robot file with attached models and references to meshes."""

    path: Path
    root: Element
    models: Mapping[str, bytes]  # XML of attached models by their token
    meshes: Mapping[str, MeshReference]  # by token

    @property
    def is_urdf(self) -> bool:
        """Whether the robot file is a URDF."""
        return self.root.tag == "robot"


def read_robot_files(path: Path) -> RobotFiles:
    """Read a robot's file, includes and attached models, but no meshes.

    A file with xacro macros is expanded first.

    Raises:
        ConfigError: a file is outside the robot's folder or missing, or the files exceed the limits.
        xml.parsers.expat.ExpatError: a file is not well-formed.
        OSError: a file cannot be read.
    """
    reader = _Reader(path)
    with open_regular(path) as file:
        data = file.read(MAX_MODEL_SIZE + 1)
    refuse_other_kinds(str(path), path.suffix, data)
    reader.count_file(path, len(data))
    if is_xacro(data):
        data = expand_xacro(path)
        reader.count_file(path, len(data))
    root, _ = reader.parse(path, data)
    refuse_other_roots(str(path), root.tag)
    return RobotFiles(path, root, reader.models, reader.meshes)


@dataclass(eq=False)
class _Reader:
    """Reader of a robot's XML files with limits and a cache."""

    path: Path
    models: dict[str, bytes] = field(default_factory=dict)
    meshes: dict[str, MeshReference] = field(default_factory=dict)
    _tokens: Iterator[int] = field(default_factory=count)
    _sizes: dict[Path, int] = field(default_factory=dict)  # [bytes] of files that were read
    _attached: dict[Path, Attached] = field(default_factory=dict)
    _open: list[Path] = field(default_factory=list)  # models that are being parsed

    def count_file(self, file: Path, size: int) -> None:
        self._sizes[file] = size
        if sum(self._sizes.values()) > MAX_MODEL_SIZE:
            most = MAX_MODEL_SIZE // 1_000_000
            raise ConfigError(f"{self.path}: more than {most} MB of XML; a robot's is below 1 MB")
        if len(self._sizes) > MAX_FILES:
            raise ConfigError(f"{self.path}: consists of more than {MAX_FILES} files")

    def read(self, name: str, starts: tuple[Path, ...], named_at: str) -> tuple[Path, bytes]:
        """Read a referenced file from the first folder that has it."""
        place = self._locate(name, starts, named_at)
        try:
            data = read_inside(self.path.parent, place, max_size=MAX_MODEL_SIZE)
        except ConfigError as error:
            raise ConfigError(f"{named_at}: reads {name}: {error}") from None
        self.count_file(place, len(data))
        return place, data

    def attach(self, name: str, starts: tuple[Path, ...], named_at: str) -> Attached:
        """Parse an attached model once and return its substitute.

        The substitute has a placeholder of the file name and the element count.
        """
        place, data = self.read(name, starts, named_at)
        if place not in self._attached:
            if place in self._open:
                raise ConfigError(f"{named_at}: attaches {name}, which holds this element")
            root, elements = self.parse(place, data)
            token = f"model-{len(self.models)}.xml"
            self.models[token] = tostring(root)
            self._attached[place] = Attached(token, elements)
        return self._attached[place]

    def parse(self, path: Path, data: bytes) -> tuple[Element, int]:
        """Parse a model and return its root and element count."""
        self._open.append(path)
        text = ModelText(path, self.read, self.attach, self._tokens)
        text.parse(path, data)
        self._open.pop()
        self.meshes.update(text.meshes())
        return text.root(), text.count

    def _locate(self, name: str, starts: tuple[Path, ...], named_at: str) -> Path:
        """Find a referenced file inside the robot's folder."""
        spelled, home = name.replace("\\", "/"), self.path.parent.resolve()
        is_foreign = "://" in spelled or spelled.startswith("/") or bool(PureWindowsPath(spelled).drive)
        try:
            places = [] if is_foreign else [(start / spelled).resolve() for start in starts]
        except RuntimeError:  # symbolic links form a cycle
            places = []
        inside = [place for place in places if place.is_relative_to(home)]
        file = next((place for place in inside if place.exists()), None)
        if file is not None:
            return file
        if is_foreign or len(inside) < len(places):
            what = f"reads {name}, outside of the robot's folder"
            raise ConfigError(f"{named_at}: {what}; copy that file into {self.path.parent}, and name it from there")
        raise ConfigError(f"{named_at}: reads {name}, which is not there; copy that file into {self.path.parent}")

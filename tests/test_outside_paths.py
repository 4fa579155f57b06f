"""Conversions of strings to paths: `outside_paths.toml` lists each with its source."""

import tomllib
from collections import Counter
from pathlib import Path

import pytest

from .outside_paths import find_places

TABLE_FILE = Path(__file__).with_name("outside_paths.toml")
PACKAGE = Path(__file__).resolve().parent.parent / "kinesic"
SOURCE_PREFIXES = ("own: ", "fixed: ", "number: ", "user: ", "checked: ", "no file: ")

Function = tuple[str, str]  # module and name


def listed() -> Counter[Function]:
    groups = tomllib.loads(TABLE_FILE.read_text(encoding="utf-8"))
    return Counter(
        {
            (module, function): count
            for module, rows in groups.items()
            for row in rows
            for function, count in row["places"].items()
        }
    )


def test_each_string_to_path_conversion_in_the_sources_is_listed_with_its_function():
    places, known, wrong = find_places(PACKAGE), listed(), []
    counts = Counter((place.module, place.function) for place in places)
    for module, function in sorted(counts.keys() | known.keys()):
        there, stands = counts[module, function], known[module, function]
        if there != stands:
            wrong.append(f'{module}: places."{function}" is {stands} in the table, and {there} in the code:')
            wrong += [
                f"    {place.module}:{place.line}: {place.text}"
                for place in places
                if (place.module, place.function) == (module, function)
            ]
    assert not wrong, "\n".join((f"who chooses these strings? answer in {TABLE_FILE.name}:", *wrong))


def test_each_listed_path_conversion_names_the_source_of_its_string():
    for module, rows in tomllib.loads(TABLE_FILE.read_text(encoding="utf-8")).items():
        for row in rows:
            assert row["why"].startswith(SOURCE_PREFIXES), (module, row["why"])
            assert len(row["why"].partition(": ")[2]) > 5, (module, row["why"])
        names = [function for row in rows for function in row["places"]]
        assert len(names) == len(set(names)), (module, "a function is listed twice")


DETECTED_PLACES = [
    "Path(block.id)",
    "Path(folder) / f'{block.id}.csv'",
    "folder / block.id",
    "(folder or Path('out')) / name",
    "self._kept / name",
    "CONFIGS / name",
    "find(name) / 'a' / name",
    "folder.joinpath(name)",
    "folder.with_name(name)",
    "folder.with_suffix('.' + name)",
    "open(name)",
    "os.open(name, os.O_RDONLY)",
    "os.replace(name, 'b')",
    "shutil.copyfile('a', name)",
    "copyfile('a', name)",
    "tempfile.mkdtemp(prefix=name, dir=folder)",
    "tempfile.TemporaryDirectory(prefix=name)",
    "wave.open(str(folder), 'rb')",
    "np.load(folder)",
    "folder.write_text('x')",
    "folder.open('wb')",
    "[each / name for each in sorted(folder.iterdir())]",
]
IGNORED_PLACES = [
    "CONFIGS / 'robots' / 'upper22.toml'",
    "Path('out')",
    "1.0 / name",
    "length / duration",
    "os.getpid()",
    "os.environ.get(name)",
    "folder.read_text()",
    "folder.open('rb')",
    "text.replace('a', name)",
]
MODULE = """
import os, shutil, tempfile, wave
from pathlib import Path
from shutil import copyfile
CONFIGS = Path(__file__).parent / "configs"

class Keeper:
    def __init__(self, kept: Path) -> None:
        self._kept = kept

def find(name: str) -> Path: ...

def act(self, block, folder: Path, name: str, length: float, duration: float, text: str) -> None:
    {}
"""


@pytest.mark.parametrize(
    ("line", "is_place"),
    [
        *((detected_place, True) for detected_place in DETECTED_PLACES),
        *((ignored_place, False) for ignored_place in IGNORED_PLACES),
    ],
)
def test_string_to_path_conversions_are_detected(tmp_path: Path, line: str, is_place: bool):
    (tmp_path / "kinesic").mkdir()
    (tmp_path / "kinesic" / "a.py").write_text(MODULE.format(line))
    places = [place for place in find_places(tmp_path / "kinesic") if place.function == "act"]
    assert bool(places) == is_place, places
    assert all((place.module, place.line) == ("kinesic/a.py", 14) for place in places)

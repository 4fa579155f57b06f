import os
import tomllib
from pathlib import Path
from time import process_time

import msgspec
import pytest

from kinesic.body.config import (
    CONFIGS,
    MOST_NESTED,
    MOST_PARTS,
    ConfigError,
    check_inside,
    find_excess,
    read_toml,
    suggestion,
)


class Wheel(msgspec.Struct, forbid_unknown_fields=True):
    radius: float


class Cart(msgspec.Struct, forbid_unknown_fields=True):
    name: str
    wheels: list[Wheel] = []


@pytest.fixture
def file(tmp_path: Path):
    def write(text: str) -> Path:
        path = tmp_path / "cart.toml"
        path.write_text(text, encoding="utf-8")
        return path

    return write


def test_a_good_file_is_read(file):
    assert read_toml(file('name = "a"\nwheels = [{ radius = 0.5 }]'), Cart) == Cart("a", [Wheel(0.5)])


def test_a_missing_file_is_named(tmp_path: Path):
    with pytest.raises(ConfigError, match=r"nowhere\.toml: no such file"):
        read_toml(tmp_path / "nowhere.toml", Cart)


def test_a_folder_is_no_file(tmp_path: Path):
    with pytest.raises(ConfigError, match="directory"):
        read_toml(tmp_path, Cart)


def test_broken_toml_names_the_line(file):
    with pytest.raises(ConfigError, match=r"not TOML.*line 2"):
        read_toml(file('name = "a"\nwheels = = 3'), Cart)


def test_bytes_that_are_no_text_are_refused(tmp_path: Path):
    path = tmp_path / "cart.toml"
    path.write_bytes(b'name = "\xff"')
    with pytest.raises(ConfigError, match="not TOML"):
        read_toml(path, Cart)


@pytest.mark.parametrize(("number", "shown"), [("nan", "nan"), ("inf", "inf"), ("-inf", "-inf")])
def test_a_number_that_is_not_finite_is_refused_with_its_place(file, number: str, shown: str):
    with pytest.raises(ConfigError, match=rf"\$\.wheels\[1\]\.radius is {shown}, must be a finite number"):
        read_toml(file(f'name = "a"\nwheels = [{{ radius = 1.0 }}, {{ radius = {number} }}]'), Cart)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('nmae = "a"', r"unknown field `nmae`; did you mean name\?"),
        ('name = "a"\nwheels = [{ radius = 1.0, rdius = 2.0 }]', r"`rdius`.*wheels.*did you mean radius\?"),
        ('name = "a"\ncolour = "red"', "unknown field `colour`; known: name, radius, wheels"),
        ("name = 3", "Expected `str`, got `int`"),
        ("", "missing required field `name`"),
    ],
)
def test_a_file_that_does_not_fit_teaches(file, text: str, message: str):
    with pytest.raises(ConfigError, match=message):
        read_toml(file(text), Cart)


def test_closest_offers_the_nearest_word_or_all():
    assert suggestion("elbwo", ["elbow", "wrist"]) == "; did you mean elbow?"
    assert suggestion("knee", ["wrist", "elbow"]) == "; known: elbow, wrist"
    assert suggestion("knee", []) == ""


def test_a_file_without_end_is_refused(tmp_path: Path):
    path = tmp_path / "large.toml"
    path.write_bytes(b"#" * 4_000_001)
    with pytest.raises(ConfigError, match=r"large\.toml: more than 4 MB"):
        read_toml(path, msgspec.Struct)
    with pytest.raises(ConfigError, match="more than 4 MB"):
        read_toml(Path("/dev/zero"), msgspec.Struct)


@pytest.mark.parametrize("text", ["a = " + "[" * 5000 + "]" * 5000, "a = " + "{b = " * 5000 + "1" + "}" * 5000])
def test_lists_inside_one_another_without_end_are_refused(tmp_path: Path, text: str):
    path = tmp_path / "deep.toml"
    path.write_text(text)
    with pytest.raises(ConfigError, match=r"deep\.toml: not TOML: in line 1 more than 32 lists"):
        read_toml(path, msgspec.Struct)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder with a file, a folder with another one, a pipe, and links to them and out of it."""
    folder = tmp_path / "folder"
    (folder / "below").mkdir(parents=True)
    for path in (folder / "own", folder / "below" / "own", tmp_path / "secret"):
        path.write_text("words")
    os.mkfifo(folder / "pipe")
    (folder / "in").symlink_to("below/own")
    (folder / "out").symlink_to("../secret")
    (folder / "up").symlink_to("..")
    (folder / "ring").symlink_to("ring")
    return folder


@pytest.mark.parametrize("name", ["own", "below/own", "below/../own", "in", "none", "../folder/own"])
def test_a_file_in_the_folder_may_be_named(folder: Path, name: str) -> None:
    check_inside(folder, folder / name)


@pytest.mark.parametrize("name", ["../secret", "/etc/hostname", "out", "up/secret", "../none", "below/../../secret"])
def test_no_file_outside_of_it(folder: Path, name: str) -> None:
    with pytest.raises(ConfigError, match=r"is outside of the folder .*folder; copy that file there"):
        check_inside(folder, folder / name)


@pytest.mark.parametrize(
    ("name", "why"), [("pipe", "no ordinary"), (".", "no ordinary"), ("ring", "ring"), ("a\0b", "null")]
)
def test_nothing_but_an_ordinary_file(folder: Path, name: str, why: str) -> None:
    with pytest.raises(ConfigError, match=why):
        check_inside(folder, folder / name)


def test_a_folder_may_be_reached_by_a_link(folder: Path) -> None:
    (folder.parent / "linked").symlink_to(folder)
    check_inside(folder.parent / "linked", folder.parent / "linked" / "own")


def test_a_whole_number_of_thousands_of_digits_is_refused(tmp_path: Path):
    path = tmp_path / "digits.toml"
    path.write_text("a = " + "1" * 5000)
    with pytest.raises(ConfigError, match=r"digits\.toml: not TOML: .*digits"):
        read_toml(path, msgspec.Struct)


def test_a_key_without_end_is_refused_before_it_is_parsed(tmp_path: Path):
    path = tmp_path / "dotted.toml"
    path.write_text(".".join(["a"] * 450_000) + " = 1")  # parsing it takes minutes
    began = process_time()
    with pytest.raises(ConfigError, match=r"dotted\.toml: not TOML: a key in line 1 has more than 32 parts"):
        read_toml(path, msgspec.Struct)
    assert process_time() - began < 1.0


def test_every_file_of_ours_may_be_parsed():
    for path in CONFIGS.rglob("*.toml"):
        assert find_excess(path.read_text(encoding="utf-8")) == "", path


@pytest.mark.parametrize(
    "text",
    [
        ".".join(["a"] * MOST_PARTS) + " = 1",
        "a = " + "[" * MOST_NESTED + "]" * MOST_NESTED,
        "a = [" + "[0.1, 0.2, 0.3], " * 5000 + "]",
        'says = "' + "One. " * 200 + '"',
        'says = """' + "a.[{" * 200 + '"""',
        "says = '''" + "a.[{" * 200 + "'''",
        "# " + "a.[" * 200,
        '"' + "a." * 200 + '" = 1',
        "a = [" + "], [".join(["1"] * 200) + "]",
    ],
)
def test_what_files_may_hold_may_be_parsed(text):
    assert find_excess(text) == ""


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("\n" + ".".join(["a"] * (MOST_PARTS + 1)) + " = 1", "a key in line 2 has more than 32 parts"),
        (" . ".join(["'a'", '"b"', "c"] * MOST_PARTS) + " = 1", "a key in line 1"),
        ("[" + ".".join(["a"] * 400) + "]", "a key in line 1"),
        ("a = " + "[" * (MOST_NESTED + 1), "more than 32 lists or tables"),
        ("a = 1\nb = " + "{c = [" * MOST_NESTED, "in line 2 more than 32"),
        ('a = "\\""\n' + "b" + ".b" * 40, "a key in line 2"),
    ],
)
def test_what_is_too_much_is_told_with_its_line(text, why):
    assert why in find_excess(text)


@pytest.mark.parametrize(
    "piece", ["a", '"', "'", "a.", ". ", '\\"""', "'''a''b", "\\", "\n", "a ", '"a\n', "[1]", "a.b\n", "'a'.", "#"]
)
def test_looking_a_text_over_takes_time_in_proportion_to_the_text(piece):
    began = process_time()
    find_excess(piece * (300_000 // len(piece)))
    assert process_time() - began < 5.0  # what takes the square of it takes hours


def test_the_parser_is_quick_with_what_passes():
    began = process_time()
    tomllib.loads("".join(f"k{k}." + ".".join(["a"] * (MOST_PARTS - 1)) + " = 1\n" for k in range(1000)))
    assert process_time() - began < 5.0

import os
import tomllib
from pathlib import Path
from time import process_time

import msgspec
import pytest

from kinesic.body.config import (
    CONFIGS,
    MAX_KEY_PARTS,
    MAX_NESTING,
    ConfigError,
    check_inside,
    describe_excess,
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


def test_valid_toml_file_is_read_into_the_schema(file):
    assert read_toml(file('name = "a"\nwheels = [{ radius = 0.5 }]'), Cart) == Cart("a", [Wheel(0.5)])


def test_error_names_a_missing_config_file(tmp_path: Path):
    with pytest.raises(ConfigError, match=r"nowhere\.toml: no such file"):
        read_toml(tmp_path / "nowhere.toml", Cart)


def test_folder_in_place_of_a_toml_file_is_refused(tmp_path: Path):
    with pytest.raises(ConfigError, match="directory"):
        read_toml(tmp_path, Cart)


def test_error_names_the_line_of_invalid_toml(file):
    with pytest.raises(ConfigError, match=r"not TOML.*line 2"):
        read_toml(file('name = "a"\nwheels = = 3'), Cart)


def test_toml_file_with_invalid_utf8_is_refused(tmp_path: Path):
    path = tmp_path / "cart.toml"
    path.write_bytes(b'name = "\xff"')
    with pytest.raises(ConfigError, match="not TOML"):
        read_toml(path, Cart)


@pytest.mark.parametrize(("number", "shown"), [("nan", "nan"), ("inf", "inf"), ("-inf", "-inf")])
def test_non_finite_number_in_a_toml_file_is_refused_with_its_field_path(file, number: str, shown: str):
    with pytest.raises(ConfigError, match=rf"\$\.wheels\[1\]\.radius is {shown}, must be a finite number"):
        read_toml(file(f'name = "a"\nwheels = [{{ radius = 1.0 }}, {{ radius = {number} }}]'), Cart)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('nmae = "a"', r"unknown field `nmae`; did you mean name\?"),
        ('name = "a"\nwheels = [{ radius = 1.0, rdius = 2.0 }]', r"`rdius`.*wheels.*did you mean radius\?"),
        ('name = "a"\ncolour = "red"', "unknown field `colour`; known: name, wheels$"),
        ('name = "a"\nwheels = [{ colour = 1.0 }]', r"wheels\[0\]`; known: radius$"),
        ('name = "a"\nwheels = [3]', r"wheels\[0\]`; a table with radius$"),
        ("name = 3", "Expected `str`, got `int`"),
        ("", "missing required field `name`"),
    ],
)
def test_invalid_config_field_error_names_the_field_and_what_is_expected(file, text: str, message: str):
    with pytest.raises(ConfigError, match=message):
        read_toml(file(text), Cart)


def test_suggestion_names_the_nearest_valid_name_or_else_all_of_them():
    assert suggestion("elbwo", ["elbow", "wrist"]) == "; did you mean elbow?"
    assert suggestion("knee", ["wrist", "elbow"]) == "; known: elbow, wrist"
    assert suggestion("knee", []) == ""


def test_config_file_over_4_megabytes_is_refused(tmp_path: Path):
    path = tmp_path / "large.toml"
    path.write_bytes(b"#" * 4_000_001)
    with pytest.raises(ConfigError, match=r"large\.toml: more than 4 MB"):
        read_toml(path, msgspec.Struct)
    with pytest.raises(ConfigError, match="more than 4 MB"):
        read_toml(Path("/dev/zero"), msgspec.Struct)


@pytest.mark.parametrize("text", ["a = " + "[" * 5000 + "]" * 5000, "a = " + "{b = " * 5000 + "1" + "}" * 5000])
def test_deeply_nested_lists_and_tables_are_refused(tmp_path: Path, text: str):
    path = tmp_path / "deep.toml"
    path.write_text(text)
    with pytest.raises(ConfigError, match=r"deep\.toml: not TOML: in line 1 more than 32 lists"):
        read_toml(path, msgspec.Struct)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Return a folder with files, a pipe, and links inside and outside."""
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
def test_config_path_inside_the_folder_is_accepted(folder: Path, name: str) -> None:
    check_inside(folder, folder / name)


@pytest.mark.parametrize("name", ["../secret", "/etc/hostname", "out", "up/secret", "../none", "below/../../secret"])
def test_config_file_outside_the_folder_is_refused(folder: Path, name: str) -> None:
    with pytest.raises(ConfigError, match=r"is outside of the folder .*folder; copy that file there"):
        check_inside(folder, folder / name)


@pytest.mark.parametrize(
    ("name", "why"), [("pipe", "not a regular"), (".", "not a regular"), ("ring", "ring"), ("a\0b", "null")]
)
def test_config_paths_that_are_pipes_folders_link_loops_or_contain_null_characters_are_refused(
    folder: Path, name: str, why: str
) -> None:
    with pytest.raises(ConfigError, match=why):
        check_inside(folder, folder / name)


def test_config_file_in_a_folder_reached_through_a_link_is_accepted(folder: Path) -> None:
    (folder.parent / "linked").symlink_to(folder)
    check_inside(folder.parent / "linked", folder.parent / "linked" / "own")


def test_toml_integer_with_thousands_of_digits_is_refused(tmp_path: Path):
    path = tmp_path / "digits.toml"
    path.write_text("a = " + "1" * 5000)
    with pytest.raises(ConfigError, match=r"digits\.toml: not TOML: .*digits"):
        read_toml(path, msgspec.Struct)


def test_toml_key_with_too_many_parts_is_refused_before_parsing(tmp_path: Path):
    path = tmp_path / "dotted.toml"
    path.write_text(".".join(["a"] * 450_000) + " = 1")  # parsing it takes minutes
    began = process_time()
    with pytest.raises(ConfigError, match=r"dotted\.toml: not TOML: a key in line 1 has more than 32 parts"):
        read_toml(path, msgspec.Struct)
    assert process_time() - began < 1.0


def test_builtin_config_files_are_within_the_toml_nesting_and_key_limits():
    for path in CONFIGS.rglob("*.toml"):
        assert describe_excess(path.read_text(encoding="utf-8")) == "", path


@pytest.mark.parametrize(
    "text",
    [
        ".".join(["a"] * MAX_KEY_PARTS) + " = 1",
        "a = " + "[" * MAX_NESTING + "]" * MAX_NESTING,
        "a = [" + "[0.1, 0.2, 0.3], " * 5000 + "]",
        'says = "' + "One. " * 200 + '"',
        'says = """' + "a.[{" * 200 + '"""',
        "says = '''" + "a.[{" * 200 + "'''",
        "# " + "a.[" * 200,
        '"' + "a." * 200 + '" = 1',
        "a = [" + "], [".join(["1"] * 200) + "]",
    ],
)
def test_toml_text_within_the_nesting_and_key_limits_is_accepted(text):
    assert describe_excess(text) == ""


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("\n" + ".".join(["a"] * (MAX_KEY_PARTS + 1)) + " = 1", "a key in line 2 has more than 32 parts"),
        (" . ".join(["'a'", '"b"', "c"] * MAX_KEY_PARTS) + " = 1", "a key in line 1"),
        ("[" + ".".join(["a"] * 400) + "]", "a key in line 1"),
        ("a = " + "[" * (MAX_NESTING + 1), "more than 32 lists or tables"),
        ("a = 1\nb = " + "{c = [" * MAX_NESTING, "in line 2 more than 32"),
        ('a = "\\""\n' + "b" + ".b" * 40, "a key in line 2"),
    ],
)
def test_toml_nesting_or_key_depth_over_the_limit_is_reported_with_its_line(text, why):
    assert why in describe_excess(text)


@pytest.mark.parametrize(
    "piece", ["a", '"', "'", "a.", ". ", '\\"""', "'''a''b", "\\", "\n", "a ", '"a\n', "[1]", "a.b\n", "'a'.", "#"]
)
def test_toml_limits_of_a_300_kb_text_are_checked_within_5_seconds(piece):
    began = process_time()
    describe_excess(piece * (300_000 // len(piece)))
    assert process_time() - began < 5.0  # what takes the square of it takes hours


def test_toml_text_with_1000_keys_of_maximum_depth_is_parsed_within_5_seconds():
    began = process_time()
    tomllib.loads("".join(f"k{k}." + ".".join(["a"] * (MAX_KEY_PARTS - 1)) + " = 1\n" for k in range(1000)))
    assert process_time() - began < 5.0

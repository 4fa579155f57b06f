"""Tests of file names made from arbitrary text."""

import pytest

from kinesic.files.plain_name import MAX_STEM_LENGTH, is_device_name, plain_stem


@pytest.mark.parametrize(
    ("text", "stem"),
    [
        ("doc", "doc"),
        ("story-2_b", "story-2_b"),
        ("/home/me/data", "home_me_data"),
        ("../../.bashrc", "bashrc"),
        ("..\\..\\boot.ini", "boot_ini"),
        ("C:\\x", "C_x"),
        ("a\0b\nc", "a_b_c"),
        ("--force", "force"),
        ("", "performance"),
        ("...", "performance"),
        ("äöü", "performance"),
        ("con", "con_"),
        ("NUL.txt", "NUL_txt"),
        ("LPT1", "LPT1_"),
        ("com\N{SUPERSCRIPT ONE}", "com"),
        ("a b  c", "a_b_c"),
    ],
)
def test_arbitrary_text_becomes_a_safe_file_name(text: str, stem: str):
    assert plain_stem(text, fallback="performance") == stem


def test_long_text_becomes_a_shortened_file_name():
    assert plain_stem("a" * 500, fallback="x") == "a" * MAX_STEM_LENGTH
    assert plain_stem("/" * 500 + "a", fallback="x") == "x"


@pytest.mark.parametrize("name", ["con", "CON", "Con.bml", "nul.a.b", "aux .txt", "COM1.toml", "com\u00b9", "conin$"])
def test_windows_device_names_are_recognised(name: str):
    assert is_device_name(name)


@pytest.mark.parametrize("name", ["console", "con1", "com", "com10", "acon", "a.con", "null", ""])
def test_ordinary_file_names_are_not_device_names(name: str):
    assert not is_device_name(name)

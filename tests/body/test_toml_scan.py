"""What TOML is looked over for: all that files need passes, what would keep the parser busy does not, and soon."""

import tomllib
from time import process_time

import pytest

from kinesic.body.config import CONFIGS
from kinesic.body.toml_scan import MOST_NESTED, MOST_PARTS, find_excess


def test_every_file_of_ours_passes():
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
def test_what_files_may_hold_passes(text):
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
def test_it_takes_time_in_proportion_to_the_text(piece):
    began = process_time()
    find_excess(piece * (1_000_000 // len(piece)))
    assert process_time() - began < 5.0  # what takes the square of it takes hours


def test_the_parser_is_quick_with_what_passes():
    began = process_time()
    tomllib.loads("".join(f"k{k}." + ".".join(["a"] * (MOST_PARTS - 1)) + " = 1\n" for k in range(1000)))
    assert process_time() - began < 5.0

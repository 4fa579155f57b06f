"""Generated reference pages: complete, and up to date with the code."""

import importlib
import re
import runpy
import sys
from pathlib import Path

import click
import msgspec
import pytest

import kinesic
from kinesic.cli import kinesic as command
from kinesic.session.options import PlanningOptions

ROOT = Path(__file__).resolve().parent.parent
GENERATOR = ROOT / "docs" / "make" / "reference"
READ_SCHEMA = re.compile(r"(?:read_toml|fit_schema)\([^()\n]*(?:\([^()]*\)[^()\n]*)*, (_?[A-Z][a-z]\w+)[,)]")
PAGES = ["command-line.md", "python.md", "toml-files.md", "messages.md", "mcp-tools.md", "examples.md", "supervisor.md"]
INTERNAL_SCHEMAS = {  # schemas of files that only kinesic itself contains
    "_File": "expressions and visemes of the face",
    "_HandsFile": "hand shapes",
    "LegibilityTable": "requirements of tests",
    "StanceFile": "standing postures of captured people",
    "BodyTable": "captured whole bodies",
    "TurnWordTable": "words that organise turns",
    "CapturedBodyTable": "captured bodies",
    "CapturedTable": "captured gestures",
    "_PlainLanguages": "words of the rules for plain text",
    "_Table": "rules of a language",
    "_Verbs": "irregular verb forms",
}


@pytest.fixture(scope="module")
def pages() -> dict[str, str]:
    """Texts of all generated pages, by file name."""
    pytest.importorskip("mcp", reason="the extra mcp is not installed, and one page lists its tools")
    written = runpy.run_path(str(GENERATOR), run_name="reference")["write_pages"]()
    return {path.name: text for path, text in written.items()}


@pytest.fixture(scope="module")
def generator(pages: dict[str, str]):
    """Modules of the generator by name."""
    return {name: sys.modules[name] for name in ("struct_tables", "toml_page", "message_page", "python_page")}


def verbs(group: click.Command, path: str) -> list[str]:
    """Return the paths of all verbs below a group."""
    if not isinstance(group, click.Group):
        return [path]
    return [verb for name, child in group.commands.items() for verb in verbs(child, f"{path} {name}")]


@pytest.mark.parametrize("name", PAGES)
def test_generated_reference_page_is_up_to_date(pages: dict[str, str], name: str):
    written = (ROOT / "docs" / "reference" / name).read_text(encoding="utf-8")
    assert written == pages[name], "run make reference"


def test_command_line_page_describes_each_verb_and_option(pages: dict[str, str]):
    page = pages["command-line.md"]
    assert [verb for verb in verbs(command, "kinesic") if f"\n## {verb}\n" not in page] == []
    perform = page.partition("\n## kinesic perform\n")[2].partition("\n## ")[0]
    options = [name for option in command.commands["perform"].params for name in option.opts if name.startswith("--")]
    assert len(options) > 20
    assert [name for name in options if f"`{name}`" not in perform] == []
    shared = page.partition("\n## Planning options\n")[2]
    assert [name for name in options if f"| `{name}`" not in perform and f"| `{name}`" not in shared] == []


def test_python_reference_page_lists_each_public_name(pages: dict[str, str], generator):
    page, place_of = pages["python.md"], generator["python_page"].place_of
    rooms = {
        "kinesic": kinesic.__all__,
        **{f"kinesic.{room}": importlib.import_module(f"kinesic.{room}").__all__ for room in ("ik", "motion")},
    }
    for room, names in rooms.items():
        for name in set(names) - {"__version__"}:
            assert f"| [`{room}.{name}`]" in page
            assert f"\n::: {place_of(room, name)}\n" in page
    assert [name for name in PlanningOptions.__annotations__ if f"| `{name}` | " not in page] == []


def test_page_of_mcp_tools_describes_every_parameter(pages: dict[str, str]):
    page = pages["mcp-tools.md"]
    assert re.findall(r"^## (\w+)$", page, re.MULTILINE)[:3] == ["perform", "say", "look"]
    rows = re.findall(r"^\| `(\w+)` \| ([^|]+) \| ([^|]*) \| ([^|]*) \|$", page, re.MULTILINE)
    assert ("count", "whole number in [1, 25]", "`8`", "Largest number of gestures in the answer.") in rows
    assert [row for row in rows if not (row[1].strip() and row[3].strip())] == []


def test_every_toml_schema_has_a_reference_section_or_is_listed_as_internal(generator):
    sources = [path.read_text(encoding="utf-8") for path in (ROOT / "kinesic").rglob("*.py")]
    calls = {name for text in sources for name in READ_SCHEMA.findall(text)}
    documented = {table.__name__ for document in generator["toml_page"].DOCUMENTS for table in document.tables}
    assert "GestureFile" in calls
    assert calls - documented == set(INTERNAL_SCHEMAS) & calls


def test_every_toml_key_and_message_field_has_a_description(generator):
    structs = [
        table for document in generator["toml_page"].DOCUMENTS for table in generator["toml_page"].list_tables(document)
    ]
    structs += generator["message_page"].list_messages()
    keys = [(table.__name__, key) for table in structs for key in generator["struct_tables"].list_keys(table)]
    assert len(keys) > 100
    assert [(name, key.name) for name, key in keys if not key.meaning] == []


def test_each_server_message_is_explained_on_the_protocol_page(generator):
    page = (ROOT / "docs" / "reference" / "wire-protocol.md").read_text(encoding="utf-8")
    verbs_of_messages = [
        generator["message_page"].verb_of(message) for message in generator["message_page"].list_messages()
    ]
    assert [verb for verb in verbs_of_messages if f'"do": "{verb}"' not in page] == []


def test_descriptions_of_toml_keys_come_from_source_comments(generator, tmp_path: Path):
    module = tmp_path / "table_with_comments.py"
    module.write_text(
        "import msgspec\nclass Parent(msgspec.Struct):\n    a: int  # first\n"
        "class Child(Parent):\n    b: float | None = None  # [m] second\n    c: list[str] = []\n",
        encoding="utf-8",
    )
    spec = importlib.util.spec_from_file_location("table_with_comments", module)
    loaded = importlib.util.module_from_spec(spec)
    sys.modules["table_with_comments"] = loaded
    spec.loader.exec_module(loaded)
    keys = generator["struct_tables"].list_keys(loaded.Child)
    assert [(key.name, key.kind, key.default, key.meaning) for key in keys] == [
        ("a", "whole number", "required", "first"),
        ("b", "number", "", "[m] second"),
        ("c", "list of texts", "", ""),
    ]
    assert issubclass(loaded.Child, msgspec.Struct)

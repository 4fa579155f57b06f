"""Blocks of the tutorials, read without executing them: each is well-formed, and `make tutorials` follows it."""

import ast
import re
import shlex
from importlib import import_module
from itertools import pairwise

import click
import pytest

from kinesic.bml.parse import parse
from kinesic.cli import kinesic
from tests.tutorials.pages import FOLDER, read_tutorial

TUTORIALS = sorted(page.stem for page in FOLDER.glob("*.md") if page.stem != "index")
FILE_LANGUAGES = {"xml", "python", "toml", "json"}


def sources(name: str, language: str) -> list[str]:
    lexemes = [example.region.lexemes for example in read_tutorial(name)]
    return [str(lexeme["source"]) for lexeme in lexemes if lexeme.get("language") == language]


def test_documentation_has_pages_of_exactly_three_tutorials():
    assert TUTORIALS == ["agent", "maker", "researcher"]


@pytest.mark.parametrize("name", TUTORIALS)
def test_each_code_block_of_a_tutorial_has_a_known_language_and_each_file_a_title(name: str):
    fences = re.findall(r"^```", (FOLDER / f"{name}.md").read_text(encoding="utf-8"), re.MULTILINE)
    blocks = [item.region.lexemes for item in read_tutorial(name) if "language" in item.region.lexemes]
    assert len(blocks) == len(fences) / 2
    assert {block["language"] for block in blocks} <= FILE_LANGUAGES | {"bash", "text"}
    assert all(block["title"] for block in blocks if block["language"] in FILE_LANGUAGES)


@pytest.mark.parametrize("name", TUTORIALS)
def test_commands_of_a_tutorial_are_followed_by_their_output(name: str):
    blocks = [item.region.lexemes for item in read_tutorial(name) if "language" in item.region.lexemes]
    kinds = [(block["language"], str(block["source"])) for block in blocks]
    silent = [source for (kind, source), (after, _) in pairwise(kinds) if kind == "bash" and after != "text"]
    assert [source for source in silent if "kinesic " in source and "git clone" not in source] == []


@pytest.mark.parametrize("name", TUTORIALS)
def test_commands_of_a_tutorial_have_valid_options(name: str):
    lines = [line for source in sources(name, "bash") for line in re.split(r"\n|;|\|", source)]
    commands = [shlex.split(line.strip(), comments=True)[1:] for line in lines if line.strip().startswith("kinesic ")]
    assert len(commands) >= 4
    for words in commands:
        command, context = kinesic, click.Context(kinesic)
        while isinstance(command, click.Group):
            result = command.get_command(context, words[0])
            assert result is not None, words[0]
            command = result
            words.pop(0)
        command.make_context("kinesic", words, **kinesic.context_settings)


@pytest.mark.parametrize("name", TUTORIALS)
def test_documents_of_a_tutorial_are_parsed_without_a_warning(name: str):
    documents = [source for source in sources(name, "xml") if "<bml" in source]
    documents += [item for source in sources(name, "python") for item in re.findall(r"<bml.*</bml>", source, re.DOTALL)]
    assert documents
    assert [notice for document in documents for notice in parse(document).notices] == []


@pytest.mark.parametrize("name", TUTORIALS)
def test_programs_of_a_tutorial_import_only_existing_names(name: str):
    nodes = [node for source in sources(name, "python") for node in ast.walk(ast.parse(source))]
    imports = [(node.module, name.name) for node in nodes if isinstance(node, ast.ImportFrom) for name in node.names]
    assert imports
    assert [module for module in imports if not hasattr(import_module(module[0]), module[1])] == []

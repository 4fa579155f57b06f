"""The page of all example programs, with their sources."""

import ast
from pathlib import Path

EXAMPLE_FOLDER = Path(__file__).resolve().parents[3] / "examples"
HEAD = """# Examples

These programs show how to use kinesic from Python. They are in the folder `examples` of the checkout, and tests run
them.

| program | purpose |
|---|---|
"""


def list_examples() -> list[Path]:
    """Return all example programs in their order."""
    return sorted(EXAMPLE_FOLDER.glob("*.py"))


def write_page() -> str:
    """Return the page with the source of every example program."""
    rows, sections = [], []
    for path in list_examples():
        source = path.read_text(encoding="utf-8")
        purpose = (ast.get_docstring(ast.parse(source)) or "").splitlines()[0]
        heading = path.stem.split("_", 1)[1].replace("_", " ").capitalize()
        rows.append(f"| [`{path.name}`](#{heading.lower().replace(' ', '-')}) | {purpose} |")
        sections += ["", f"## {heading}", "", f"`examples/{path.name}`", "", f"```python\n{source.rstrip()}\n```"]
    return HEAD + "\n".join([*rows, *sections]) + "\n"

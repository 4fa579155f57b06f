"""Write the generated pages of docs/reference.

The pages are command line, Python, TOML files, messages, tools, examples and supervisor.

.venv/bin/python docs/make/reference
"""

from pathlib import Path

import command_line_page
import examples_page
import message_page
import python_page
import supervisor_page
import toml_page
import tools_page

REFERENCE_FOLDER = Path(__file__).resolve().parents[2] / "reference"


def write_pages() -> dict[Path, str]:
    """Return the text of every generated page."""
    return {
        REFERENCE_FOLDER / "command-line.md": command_line_page.write_page(),
        REFERENCE_FOLDER / "python.md": python_page.write_page(),
        REFERENCE_FOLDER / "toml-files.md": toml_page.write_page(),
        REFERENCE_FOLDER / "messages.md": message_page.write_page(),
        REFERENCE_FOLDER / "mcp-tools.md": tools_page.write_page(),
        REFERENCE_FOLDER / "examples.md": examples_page.write_page(),
        REFERENCE_FOLDER / "supervisor.md": supervisor_page.write_page(),
    }


if __name__ == "__main__":
    for path, text in write_pages().items():
        path.write_text(text, encoding="utf-8")

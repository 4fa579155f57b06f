"""Tutorial pages, read and executed block by block.

| block of the page | effect |
|---|---|
| `bash` | commands in the first terminal, which must succeed |
| `bash title="second terminal"` | commands in another terminal, which may run on |
| `text` | output of the commands before; `...` is any text, a decimal differs by at most 2 % or one last digit |
| `<!-- measured: next -->` | decimals in the next output depend on the machine, and are any number |
| any language with `title="FILE"` | content of that file |
| `<!-- press-enter: TERMINAL -->` | Enter in that terminal |
| `<!--- skip: next -->` | the next block is not executed |
"""

import os
import re
import socket
import sys
from contextlib import ExitStack
from pathlib import Path

from sybil import Document, Example
from sybil.parsers.markdown import SkipParser
from sybil.parsers.markdown.lexers import DirectiveInHTMLCommentLexer, RawFencedCodeBlockLexer
from sybil.region import Region

from kinesic.client import DEFAULT_PORT
from tests.tutorials.terminals import Terminal

FOLDER = Path(__file__).resolve().parents[2] / "docs" / "tutorials"
FIRST_TERMINAL = "first terminal"  # name of the terminal of blocks without a title
INFO = re.compile(r'(?P<language>\w+)(?: title="(?P<title>[^"]+)")?$\n', re.MULTILINE)


def read_tutorial(name: str) -> Document:
    """Read a tutorial's blocks."""
    return read_page(FOLDER / f"{name}.md")


def read_page(path: Path) -> Document:
    """Parse the code blocks and the marking comments of a tutorial page."""
    return Document.parse(str(path), SkipParser(), _blocks, _presses, _marks)


def _blocks(document: Document) -> list[Region]:
    regions = list(RawFencedCodeBlockLexer(INFO)(document))
    for region in regions:
        region.evaluator = _follow
    return regions


def _presses(document: Document) -> list[Region]:
    regions = list(DirectiveInHTMLCommentLexer(directive="press-enter", arguments=r"[^\n>]+?")(document))
    for region in regions:
        region.evaluator = _press_enter
    return regions


def _marks(document: Document) -> list[Region]:
    regions = list(DirectiveInHTMLCommentLexer(directive="measured", arguments="next")(document))
    for region in regions:
        region.evaluator = _mark_measured
    return regions


def execute(document: Document, folder: Path) -> None:
    """Execute a page in an empty folder, as its reader does.

    Raises:
        TutorialError: a command fails, or prints other output than the page shows.
    """
    with ExitStack() as ending:
        document.namespace["desk"] = desk = Desk(folder, ending)
        for example in document:
            example.evaluate()
        desk.first.await_end()
        for terminal in reversed(desk.terminals.values()):
            terminal.interrupt()


class Desk:
    """Folder and terminals of the reader of one page."""

    def __init__(self, folder: Path, ending: ExitStack) -> None:
        self.folder, self.terminals, self._ending = folder, dict[str, Terminal](), ending
        self._port = _free_port()
        self.is_measured = False  # whether decimals of the next output depend on the machine
        self.first = self.last = self.terminal(FIRST_TERMINAL)

    def terminal(self, name: str) -> Terminal:
        """Return the terminal of this name, which is opened if necessary."""
        if name not in self.terminals:
            home = self.folder.parent / "home"
            path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
            own = {"PATH": path, "HOME": str(home), "XDG_CONFIG_HOME": str(home), "PYTHONUNBUFFERED": "1"}
            own["PYTHONPATH"] = str(_hide_neural_voice(home))
            self.terminals[name] = Terminal(self.folder, os.environ | own)
            self._ending.callback(self.terminals[name].kill)
        return self.terminals[name]

    def at_own_port(self, text: str) -> str:
        """Replace the default port of the server, so that several servers can run."""
        text = re.sub(r"kinesic (serve|studio)\b", rf"kinesic \1 --listen 127.0.0.1:{self._port}", text)
        return text.replace("Client()", f"Client(port={self._port})").replace(str(DEFAULT_PORT), str(self._port))


def _free_port() -> int:
    with socket.socket() as server:
        server.bind(("127.0.0.1", 0))
        return server.getsockname()[1]


def _follow(example: Example) -> None:
    """Type, run or compare a code block as a reader of the tutorial does."""
    desk: Desk = example.namespace["desk"]
    lexemes = example.region.lexemes
    language, title, source = lexemes["language"], lexemes["title"], desk.at_own_port(str(lexemes["source"]))
    if language == "text":
        desk.last.await_output(source, is_measured=desk.is_measured)
        desk.is_measured = False
        return
    desk.first.await_end()
    if language == "bash":
        desk.last = desk.terminal(title or FIRST_TERMINAL)
        desk.last.start(source)
    else:
        (desk.folder / title).write_text(source, encoding="utf-8")


def _mark_measured(example: Example) -> None:
    desk: Desk = example.namespace["desk"]
    desk.is_measured = True


def _press_enter(example: Example) -> None:
    desk: Desk = example.namespace["desk"]
    desk.terminal(str(example.region.lexemes["arguments"])).press_enter()


def _hide_neural_voice(home: Path) -> Path:
    """Return a folder of modules in which hibari is no package, because tutorials install none."""
    home.mkdir(exist_ok=True)
    (home / "hibari.py").touch()
    return home

"""`kinesic studio`: the server, and a page in the browser on which documents are written, seen and performed."""

import webbrowser
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path

import click

from kinesic.body.config import ConfigError
from kinesic.cli.live.attached import ask_robot, read_server, set_up_like, show_page
from kinesic.cli.live.door import Door
from kinesic.cli.live.folder_gestures import read_folder
from kinesic.cli.live.frozen import FrozenPlanning
from kinesic.cli.live.serve import open_and_serve, read_address
from kinesic.cli.options import Performers, Planning
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.face.show.window import has_display
from kinesic.planning.setup import Setup
from kinesic.serve.desk.documents import is_document_name
from kinesic.serve.server import Address
from kinesic.studio.page import page_files


@dataclass(frozen=True, eq=False)
class StudioPlanning(FrozenPlanning):
    """Planning that also knows the gestures of the studio's folder, as they are when it is set up."""

    folder: Path = Path()

    def set_up(self) -> Setup:
        """Makes what planning needs, with the gestures of the folder that can be read."""
        setup = super().set_up()
        with suppress(ConfigError):  # they contradict each other: none of them is known
            return replace(setup, lexicon=Lexicon.load(*read_folder(self.folder).parts, self.gestures))
        return setup


def open_studio(
    file: Path | None,
    planning: Planning,
    door: Door,
    performers: Performers,
    folder: Path | None,
    sound: bool | None,
    browser: bool,
    rules: tuple[str, ...],
    connect: str | None = None,
) -> int:
    """Serves the page, and clients like any server, until somebody ends it."""
    if door.listen == "none":
        raise ConfigError("--listen none: a page needs an address; give HOST:PORT")

    def opened(address: Address) -> None:
        url = f"http://{address}/"
        click.echo(f"the studio: {url}", err=True)
        if browser and has_display():
            webbrowser.open(url)

    if connect is not None:
        return _attach(file, planning, door, connect, opened)
    place = folder or (Path() if file is None else file.parent)
    if file is not None:
        _check_document(file, place)
    if not place.is_dir():
        raise ConfigError(f"--folder {place}: there is no such folder; make it first")
    known = replace(StudioPlanning.of(planning), folder=place.resolve())
    setup = known.set_up()
    files = page_files(setup.robot, setup.lexicon, style=planning.style, document=None if file is None else file.name)
    for fault in read_folder(known.folder).faults:
        click.echo(f"passed over: {fault}", err=True)

    return open_and_serve(
        known, door, performers, sound, rules, files=files, folder=known.folder, armed=False, opened=opened
    )


def _attach(file: Path | None, planning: Planning, door: Door, connect: str, opened: Callable[[Address], None]) -> int:
    """Shows the page for a robot that another server drives: its folder, its gestures, its rules."""
    if file is not None:
        raise ConfigError(f"{file}: with --connect, documents are those of the server's folder; open it on the page")
    robot, place = read_server(connect), read_address(door.listen, token=None)
    if place is None:
        raise ConfigError("--listen none: a page needs an address; give HOST:PORT")
    setup = set_up_like(planning, ask_robot(robot, door.token), robot)
    return show_page(place, robot, page_files(setup.robot, setup.lexicon, style=planning.style), opened)


def _check_document(file: Path, folder: Path) -> None:
    if not is_document_name(file.name):
        raise ConfigError(f"{file}: give NAME.bml, of letters, digits, - and _, and no device of Windows such as con")
    if file.parent.resolve() != folder.resolve():
        raise ConfigError(f"{file} is not in the folder {folder}, outside of which nothing is read")
    if not file.is_file():
        raise ConfigError(f"{file}: there is no such file")

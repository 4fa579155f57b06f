"""Verb `kinesic studio`: a server with a web page for documents."""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path

import click

from kinesic.body.config import ConfigError
from kinesic.cli.browser import open_in_browser
from kinesic.cli.live.access_options import AccessOptions
from kinesic.cli.live.addresses import read_listen_address
from kinesic.cli.live.attached import ask_robot, read_server, set_up_like, show_page
from kinesic.cli.live.folder_gestures import read_folder
from kinesic.cli.live.frozen import FrozenPlanning
from kinesic.cli.live.serve import open_and_serve
from kinesic.cli.options import Performers, Planning
from kinesic.cli.progress import show_stages
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.planning.setup import Setup
from kinesic.serve.address import Address
from kinesic.serve.desk.documents import is_document_name
from kinesic.studio.page import page_files


@dataclass(frozen=True, eq=False)
class StudioPlanning(FrozenPlanning):
    """Planning snapshot plus the current gestures of the studio's folder.

    The gestures are read again on each setup.
    """

    folder: Path = Path()

    def set_up(self) -> Setup:
        """Build the planning setup with all valid gestures of the folder."""
        setup = super().set_up()
        with suppress(ConfigError):  # Contradictory gesture files are all ignored.
            return replace(setup, lexicon=Lexicon.load(*read_folder(self.folder).parts, self.gestures))
        return setup


def open_studio(
    file: Path | None,
    planning: Planning,
    access_options: AccessOptions,
    performers: Performers,
    folder: Path | None,
    sound: bool | None,
    browser: bool,
    rules: tuple[str, ...],
    connect: str | None = None,
) -> int:
    """Serve the studio page and other clients until the user ends it."""
    if access_options.listen == "none":
        raise ConfigError("--listen none: a page needs an address; give HOST:PORT")

    def announce(address: Address) -> None:
        url = f"http://{address}/"
        click.echo(f"the studio: {url}", err=True)
        if browser:
            open_in_browser(url)

    if connect is not None:
        return _attach(file, planning, access_options, connect, announce)
    document_folder = folder or (Path() if file is None else file.parent)
    if file is not None:
        _check_document(file, document_folder)
    if not document_folder.is_dir():
        raise ConfigError(f"--folder {document_folder}: there is no such folder; make it first")
    snapshot = replace(StudioPlanning.of(planning), folder=document_folder.resolve())
    with show_stages() as stage:
        stage("reading the robot")
        setup = snapshot.set_up()
        document = None if file is None else file.name
        files = page_files(setup.robot, setup.lexicon, style=planning.style, document=document)
    for fault_text in read_folder(snapshot.folder).faults:
        click.echo(f"skipped: {fault_text}", err=True)

    return open_and_serve(
        snapshot,
        access_options,
        performers,
        sound,
        rules,
        files=files,
        folder=snapshot.folder,
        armed=False,
        announce=announce,
    )


def _attach(
    file: Path | None,
    planning: Planning,
    access_options: AccessOptions,
    connect: str,
    announce: Callable[[Address], None],
) -> int:
    """Serve the studio page for a robot that another server drives.

    Documents, gestures and quotas are those of that server.
    """
    if file is not None:
        raise ConfigError(f"{file}: with --connect, documents are in the server's folder; open it on the page")
    robot_address, page_address = read_server(connect), read_listen_address(access_options.listen, token=None)
    if page_address is None:
        raise ConfigError("--listen none: a page needs an address; give HOST:PORT")
    setup = set_up_like(planning, ask_robot(robot_address, access_options.token), robot_address)
    return show_page(
        page_address, robot_address, page_files(setup.robot, setup.lexicon, style=planning.style), announce
    )


def _check_document(file: Path, folder: Path) -> None:
    if not is_document_name(file.name):
        raise ConfigError(
            f"{file}: name it NAME.bml, with letters, digits, - and _, and not like a Windows device such as con"
        )
    if file.parent.resolve() != folder.resolve():
        raise ConfigError(f"{file} is outside the folder {folder}; only files in it are read")
    if not file.is_file():
        raise ConfigError(f"{file}: there is no such file")

"""Verbs `kinesic gestures`: list, show and draw the lexicon's gestures."""

import json
from collections.abc import Callable, Iterator
from dataclasses import asdict
from pathlib import Path

import click

from kinesic.bml.block import BmlError
from kinesic.body.config import ConfigError
from kinesic.body.robot import Robot
from kinesic.cli.gesture_search import check_category
from kinesic.cli.option_values import GesturePicture
from kinesic.cli.plain_words import printable
from kinesic.cli.progress import show_stages, stage_progress
from kinesic.cli.screen.table import Table
from kinesic.cli.terminal import console, quote_text
from kinesic.expressivity.lexicon.body_form import NO_BODY
from kinesic.expressivity.lexicon.directions import FILE_ORDER, format_direction
from kinesic.expressivity.lexicon.form import Match
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.face.display import DisplayError
from kinesic.face.show.files import check_film, save_film
from kinesic.files.output_file import check_file, new_file
from kinesic.hardware.protocol.servo_map import load_robot
from kinesic.planning.setup import Setup
from kinesic.session.setup import set_up
from kinesic.sim.film import FilmError
from kinesic.studies.gestures.isolated import Show, key_postures, plan_gesture
from kinesic.studies.gestures.portraits import TURNTABLE_RATE, draw_turntable
from kinesic.studies.gestures.sheet import MAX_POSTURES, check_picture, draw_gesture_sheet, draw_portraits, draw_strip
from kinesic.studies.gestures.vocabulary import list_vocabulary

VECTOR_SUFFIXES = (".svg", ".svgz", ".pdf", ".ps", ".eps", ".pgf")  # suffixes of vector graphics


def list_gestures(lexicon: Path | None, robot: str, category: str | None, as_json: bool) -> int:
    """Print a table or a JSON vocabulary of all gestures."""
    with show_stages() as stage:
        stage("reading the gestures")
        setup = set_up(load_robot(robot), lexicon=lexicon)
        entries = list_vocabulary(setup.lexicon, setup.pace)
    categories = sorted({entry.category for entry in entries})
    check_category(category, categories)
    entries = [entry for entry in entries if category in (None, entry.category)]
    if as_json:
        click.echo(json.dumps([asdict(entry) for entry in entries], indent=1))
        return 0
    table = Table("gesture", "category", "hands", "tempo", "stroke s", "body", "description")
    for entry in entries:
        tempo = "" if entry.tempo == "neutral" else entry.tempo
        cells = (
            entry.id,
            entry.category,
            " ".join(entry.hands),
            tempo,
            f"{entry.stroke_s:.1f}",
            entry.body,
            entry.says,
        )
        table.add_row(*map(quote_text, cells))
    console().print(table)
    return 0


def show_gesture(lexeme: str, lexicon: Path | None) -> int:
    """Print the key postures of a gesture or of its substitute."""
    lexicon_data = Lexicon.load(lexicon)
    match = _find_gesture(lexeme, lexicon_data)
    form = match.form
    note = match.substitute or (f"{lexeme} is a synonym" if match.kind == "synonym" else "")
    tempo = "" if form.tempo == "neutral" else f", {form.tempo}"
    click.echo(printable(f"{form.id} ({form.category}{tempo}){', ' + note if note else ''}"))
    sense = lexicon_data.sense(form)
    if sense.says:
        click.echo(printable(sense.says))
    click.echo(printable(f"meanings: {', '.join(sense.words)}"))
    if names := lexicon_data.names_of(form.id):
        click.echo(printable(f"synonyms: {', '.join(names)}"))
    click.echo(f"body: {form.body if form.body != NO_BODY else 'hands only'}")
    headings = ("key", "hand", "outward", "up", "forward", "palm", "pointing", "shape", "openness", "touches", "path")
    table = Table(*headings)
    for number, key in enumerate(form.keys, start=1):
        for side, pose in sorted(key.hands.items()):
            position = [f"{value:.2f}" for value in pose.position[list(FILE_ORDER)]]
            palm, pointing = (
                "" if direction is None else format_direction(direction) for direction in (pose.palm, pose.pointing)
            )
            details = pose.shape or "", f"{pose.openness:.2f}", pose.touch or "", pose.path.kind if pose.path else ""
            table.add_row(str(number), side, *position, palm, pointing, *map(quote_text, details))
    console().print(table)
    return 0


def render_gestures(
    lexeme: str | None, all_gestures: bool, picture: GesturePicture, lexicon: Path | None, robot: str
) -> int:
    """Draw one gesture as key postures or turntable, or all gestures."""
    turntable, out = picture.turntable, picture.out
    if (lexeme is None) != all_gestures:
        raise click.UsageError("name one gesture, or give --all")
    if turntable and (all_gestures or picture.drawn):
        raise click.UsageError(f"--turntable films one gesture: leave out {'--all' if all_gestures else '--drawn'}")
    _check_suffix(out, turntable)
    check_file(out, force=picture.force)
    setup = set_up(load_robot(robot), lexicon=lexicon)
    with new_file(out, force=picture.force) as temporary, show_stages() as stage:
        if lexeme is None:
            gestures = list(_plan_feasible_gestures(setup, stage_progress(stage, "planning gestures")))
            stage("drawing")
            draw_gesture_sheet(gestures, setup.robot, temporary)
        else:
            stage("planning")
            match = _find_gesture(lexeme, setup.lexicon)
            form, description = match.form, setup.lexicon.sense(match.form).says
            planned = plan_gesture(form, setup, setup.lexicon.named_hands(form))
            gesture = key_postures(form, planned, MAX_POSTURES)
            if turntable:
                _save_turntable(gesture, setup.robot, temporary, stage_progress(stage, "drawing"))
            else:
                stage("drawing")
                _draw_key_postures(gesture, setup.robot, temporary, description, drawn=picture.drawn)
    if lexeme is not None and match.substitute:
        click.echo(printable(f"{lexeme}: {match.substitute}"))
    click.echo(f"{'film' if turntable else 'picture'}: {out}")
    return 0


def _check_suffix(out: Path, turntable: bool) -> None:
    if not turntable:
        check_picture(out)
        return
    try:
        check_film(out)
    except DisplayError as error:
        raise ConfigError(str(error)) from None


def _save_turntable(gesture: Show, robot: Robot, path: Path, progress: Callable[[float], None]) -> None:
    try:
        save_film(
            draw_turntable(robot, gesture.postures[gesture.stroke], gesture.faces[gesture.stroke], progress),
            path,
            rate=TURNTABLE_RATE,
        )
    except (FilmError, DisplayError) as error:
        raise ConfigError(f"no turntable: {error}") from None


def _draw_key_postures(gesture: Show, robot: Robot, path: Path, description: str, *, drawn: bool) -> None:
    """Render the key postures, or draw them as lines.

    Lines are drawn on request, for vector formats, and where OpenGL does not work.
    """
    if not drawn and path.suffix.lower() not in VECTOR_SUFFIXES:
        try:
            draw_portraits(gesture, robot, path, says=description)
        except FilmError as error:
            click.echo(printable(f"kinesic: drawn as lines: {error}"), err=True)
        else:
            return
    draw_strip(gesture, robot, path, says=description)


def _plan_feasible_gestures(setup: Setup, progress: Callable[[float], None]) -> Iterator[Show]:
    """Yield key postures of all feasible gestures.

    Infeasible gestures are reported on standard error.
    """
    for k, form in enumerate(setup.lexicon.forms):
        progress(k / len(setup.lexicon.forms))
        try:
            yield key_postures(form, plan_gesture(form, setup), MAX_POSTURES)
        except BmlError as error:
            click.echo(printable(f"kinesic: {error}"), err=True)


def _find_gesture(lexeme: str, lexicon: Lexicon) -> Match:
    match = lexicon.find(lexeme)
    if match is None:
        similar = ", ".join(lexicon.near(lexeme))
        raise BmlError(f"no gesture {lexeme}{f'; similar: {similar}' if similar else ''}")
    return match

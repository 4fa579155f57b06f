"""`kinesic gestures`: what the lexicon offers, in words, in numbers and in pictures."""

import json
from collections.abc import Callable, Iterator
from dataclasses import asdict
from pathlib import Path

import click
from rich.table import Table

from kinesic.bml.block import BmlError
from kinesic.body.config import ConfigError, suggestion
from kinesic.body.robot import Robot
from kinesic.cli.plain_words import printable
from kinesic.cli.progress import share_of, show_stages
from kinesic.cli.terminal import console, quote_text
from kinesic.controller.perform import set_up
from kinesic.expressivity.lexicon.body_form import NO_BODY
from kinesic.expressivity.lexicon.form import Match
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.face.display import DisplayError
from kinesic.face.show.files import check_film, save_film
from kinesic.files.output_file import check_file, new_file
from kinesic.hardware.protocol.servo_map import load_robot
from kinesic.planning.setup import Setup
from kinesic.sim.film import FilmError
from kinesic.studies.gestures.isolated import Show, key_postures, plan_gesture
from kinesic.studies.gestures.portraits import RATE, draw_round
from kinesic.studies.gestures.sheet import MOST_POSTURES, check_picture, draw_gesture_sheet, draw_portraits, draw_strip
from kinesic.studies.gestures.vocabulary import vocabulary

LINES = (".svg", ".svgz", ".pdf", ".ps", ".eps", ".pgf")  # endings of pictures without pixels


def list_gestures(lexicon: Path | None, robot: str, category: str | None, as_json: bool) -> int:
    """Lists all gestures."""
    known = set_up(load_robot(robot), lexicon=lexicon)
    entries = vocabulary(known.lexicon, known.pace)
    kinds = sorted({entry.category for entry in entries})
    if category is not None and category not in kinds:
        raise ConfigError(f"no category {category}{suggestion(category, kinds)}; there are {', '.join(kinds)}")
    entries = [entry for entry in entries if category in (None, entry.category)]
    if as_json:
        click.echo(json.dumps([asdict(entry) for entry in entries], indent=1))
        return 0
    table = Table("gesture", "category", "hands", "tempo", "stroke s", "body", "what is done", box=None)
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
    """Prints the gesture of a lexeme, or its substitute, key by key."""
    known = Lexicon.load(lexicon)
    match = _found(lexeme, known)
    form = match.form
    how = match.substitute or (f"{lexeme} is a synonym" if match.kind == "synonym" else "")
    tempo = "" if form.tempo == "neutral" else f", {form.tempo}"
    click.echo(printable(f"{form.id} ({form.category}{tempo}){', ' + how if how else ''}"))
    sense = known.sense(form)
    if sense.says:
        click.echo(printable(sense.says))
    click.echo(printable(f"meanings: {', '.join(sense.words)}"))
    if names := known.names_of(form.id):
        click.echo(printable(f"synonyms: {', '.join(names)}"))
    click.echo(f"body: {form.body if form.body != NO_BODY else 'the hands alone'}")
    headings = ("key", "hand", "forward", "outward", "up", "palm", "pointing", "shape", "openness", "touches", "path")
    table = Table(*headings, box=None)
    for number, key in enumerate(form.keys, start=1):
        for side, pose in sorted(key.hands.items()):
            position = [f"{value:.2f}" for value in pose.position]
            palm, pointing = (
                "" if way is None else " ".join(f"{value:.1f}" for value in way) for way in (pose.palm, pose.pointing)
            )
            more = pose.shape or "", f"{pose.openness:.2f}", pose.touch or "", pose.path.kind if pose.path else ""
            table.add_row(str(number), side, *position, palm, pointing, *map(quote_text, more))
    console().print(table)
    return 0


def render_gestures(
    lexeme: str | None,
    whole: bool,
    turntable: bool,
    drawn: bool,
    out: Path,
    force: bool,
    lexicon: Path | None,
    robot: str,
) -> int:
    """Draws key postures of one gesture side by side, its stroke from all around, or all gestures at their strokes."""
    if (lexeme is None) != whole:
        raise click.UsageError("name one gesture, or give --all")
    if turntable and (whole or drawn):
        raise click.UsageError(f"--turntable turns one gesture in a film: leave out {'--all' if whole else '--drawn'}")
    _check_ending(out, turntable)
    check_file(out, force=force)
    known = set_up(load_robot(robot), lexicon=lexicon)
    with new_file(out, force=force) as fresh, show_stages() as stage:
        if lexeme is None:
            shows = list(_drawable(known, share_of(stage, "planning gestures")))
            stage("drawing them")
            draw_gesture_sheet(shows, known.robot, fresh)
        else:
            stage("planning")
            form = _found(lexeme, known.lexicon).form
            shown, says = key_postures(form, plan_gesture(form, known), MOST_POSTURES), known.lexicon.sense(form).says
            if turntable:
                _save_turntable(shown, known.robot, fresh, share_of(stage, "drawing"))
            else:
                stage("drawing")
                _draw_one(shown, known.robot, fresh, says, drawn=drawn)
    click.echo(f"{'film' if turntable else 'picture'}: {out}")
    return 0


def _check_ending(out: Path, turntable: bool) -> None:
    if not turntable:
        check_picture(out)
        return
    try:
        check_film(out)
    except DisplayError as error:
        raise ConfigError(str(error)) from None


def _save_turntable(shown: Show, robot: Robot, path: Path, progress: Callable[[float], None]) -> None:
    try:
        save_film(draw_round(robot, shown.postures[shown.stroke], shown.faces[shown.stroke], progress), path, rate=RATE)
    except (FilmError, DisplayError) as error:
        raise ConfigError(f"no turntable: {error}") from None


def _draw_one(shown: Show, robot: Robot, path: Path, says: str, *, drawn: bool) -> None:
    """Draws with light and shade, or in lines: where they are asked for, or scale, or nothing else can be drawn."""
    if not drawn and path.suffix.lower() not in LINES:
        try:
            draw_portraits(shown, robot, path, says=says)
        except FilmError as error:
            click.echo(printable(f"kinesic: drawn in lines: {error}"), err=True)
        else:
            return
    draw_strip(shown, robot, path, says=says)


def _drawable(known: Setup, progress: Callable[[float], None]) -> Iterator[Show]:
    """Yields all gestures that the robot can play; the others are named on standard error."""
    for k, form in enumerate(known.lexicon.forms):
        progress(k / len(known.lexicon.forms))
        try:
            yield key_postures(form, plan_gesture(form, known), MOST_POSTURES)
        except BmlError as error:
            click.echo(printable(f"kinesic: {error}"), err=True)


def _found(lexeme: str, lexicon: Lexicon) -> Match:
    match = lexicon.find(lexeme)
    if match is None:
        near = ", ".join(lexicon.near(lexeme))
        raise BmlError(f"no gesture {lexeme}{f'; near to it: {near}' if near else ''}")
    return match

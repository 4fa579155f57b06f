"""Verb `kinesic plan`: write a document's motion or print its timeline.

Nothing moves.
"""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import click

from kinesic.bml.block import Behaviour, BmlError, Gesture, Speech
from kinesic.bml.reading.wrapping import OpenedDocument, open_document
from kinesic.body.config import ConfigError
from kinesic.body.robot import SIDES, Side
from kinesic.cli.options import Planning, read_input
from kinesic.cli.plain_words import printable, printable_xml
from kinesic.cli.progress import show_stages
from kinesic.cli.screen.console import Console
from kinesic.cli.screen.table import Table
from kinesic.cli.summary import print_notices
from kinesic.cli.terminal import console, error_console, quote_text
from kinesic.files.output_file import check_file
from kinesic.intent.author import AuthoredText
from kinesic.intent.fml.author import is_fml
from kinesic.intent.manuscript.pieces import SpokenText
from kinesic.metrics.synchrony import StrokeLag, compute_median_lag, measure_planned_lags
from kinesic.planning.certify import certify
from kinesic.planning.clearance import Conditioner
from kinesic.planning.files.motion_files import check_motion_file, save_motion
from kinesic.planning.plan import Plan
from kinesic.planning.setup import Setup
from kinesic.planning.syncs import SHIFT_TO_WARN, SyncTime
from kinesic.report.gltf.scene import SCENE_SUFFIX as SCENE
from kinesic.report.gltf.scene import is_scene, save_scene, save_voice
from kinesic.report.labels import label
from kinesic.session.documents import TEXT_SUFFIXES, divide_long, is_spoken_file, write_fml, write_text
from kinesic.session.plan import is_motion_file, plan, plan_motion_file, plan_parts, plan_plain_text

COLUMN_SYNCS = ("start", "end")  # sync points with their own column in the timeline
MAX_SPEECH_LENGTH = 30  # [characters] speech shown in the timeline
HAND_LABELS: Mapping[tuple[Side, ...], str] = {
    (): "",
    ("l",): ", left hand",
    ("r",): ", right hand",
    ("l", "r"): ", both hands",
}


def plan_file(file: str, planning: Planning, out: Path | None, force: bool, to: str, optimal: bool) -> int:
    """Plan a document or a motion, and write or print it.

    Without a file, the timeline is printed. With `to` = bml, nothing is planned: the document's BML is printed.

    Raises:
        ConfigError: the optimum of a ready motion is requested, which has no key times to move.
    """
    if to == "bml":
        return _print_bml(file, planning.set_up())
    if optimal and is_motion(file):
        raise ConfigError(f"{file}: --optimal moves the key times of a document, and a motion has none")
    if out is not None:
        check_motion_file(out, also=SCENE)
        check_file(out, force=force)
    if parts := divide_input(file, planning):
        return _print_parts(parts, file, planning, out)
    with show_stages() as stage:
        stage("planning")
        setup = planning.set_up()
        planned = plan_input(file, setup, conditioned=_choose_conditioner(optimal))
    lags = measure_planned_lags(planned)
    voice = None
    if out is None:
        print_timeline(planned, lags, console())
    elif is_scene(out):
        voice = save_voice(planned, out, force=force)
        save_scene(planned, out, force=force)
    else:
        save_motion(planned.trajectory, setup.robot, out, force=force)
    print_notices(planned, error_console())
    median_lag = compute_median_lag(lags)
    if median_lag is not None:
        click.echo(f"hands are fastest {median_lag:.2f} s from their times on words (median, strokes: {len(lags)})")
    click.echo(f"{planned.duration:.2f} s, {len(planned.postures.postures)} keys")
    if voice is not None:
        click.echo(f"voice: {voice}")
    click.echo("nothing written; --out motion.npz (.csv, .bap) writes the motion" if out is None else f"motion: {out}")
    return 0


def divide_input(file: str, planning: Planning) -> tuple[SpokenText, ...]:
    """Divide a text file that is too long for one plan.

    Return no parts for a shorter text, or another kind of file.
    """
    is_text = Path(file).suffix.lower() in TEXT_SUFFIXES
    return divide_long(read_input(file), planning.options) if is_text else ()


def _print_parts(parts: Sequence[SpokenText], file: str, planning: Planning, out: Path | None) -> int:
    """Print the timeline of every part of a long text.

    Raises:
        ConfigError: a motion file is requested, which holds one plan.
    """
    if out is not None:
        raise ConfigError(f"{out}: a motion holds one part of a text, not {len(parts)}: divide {document_name(file)}")
    with show_stages() as stage:
        stage("planning part 1")
        for number, planned in enumerate(plan_parts(parts, planning.set_up(), source=document_name(file)), 1):
            click.echo(f"part {number} of {len(parts)}, {planned.duration:.2f} s")
            print_timeline(planned, measure_planned_lags(planned), console())
            print_notices(planned, error_console())
            stage(f"planning part {number + 1}")
    return 0


def _choose_conditioner(optimal: bool) -> Conditioner:
    """Return the limit solver: linear programs, or IPOPT for optimal key times."""
    if not optimal:
        return certify
    from kinesic.planning.optimal import certify_optimal  # noqa: PLC0415 - CasADi is slow to import

    return certify_optimal


def _print_bml(file: str, setup: Setup) -> int:
    """Print the BML generated from a plain text or FML.

    Raises:
        BmlError: the document is BML already, or a motion.
    """
    content: str | bytes = read_input(file)
    opened = OpenedDocument(content) if is_spoken_file(file, content) else open_document(content)
    for part in opened.surroundings:
        click.echo(f"warning: {printable(part)}", err=True)
    content = opened.text
    if is_spoken_file(file, content):
        print_written(lambda known: write_text(content, known), lambda: setup)
    elif is_fml(content):
        bml, warnings = write_fml(content, setup, source=document_name(file))
        click.echo(printable_xml(bml), nl=False)
        for warning in warnings:
            click.echo(printable(warning), err=True)
    else:
        raise BmlError(
            f"{document_name(file)}: the document is BML already, or a motion; --to bml is for FML and plain text"
        )
    return 0


def print_written(write: Callable[[Setup], AuthoredText], load_setup: Callable[[], Setup]) -> None:
    """Print the BML of a text or recording, and warnings to stderr."""
    with show_stages() as stage:
        stage("writing BML")
        written = write(load_setup())
    click.echo(printable_xml(written.bml), nl=False)
    for warning in written.warnings:
        click.echo(f"warning: {printable(warning)}", err=True)


def document_name(file: str) -> str:
    """Return a document's name for messages and reports."""
    return "stdin" if file == "-" else file


def is_motion(file: str) -> bool:
    """Return whether the file is a motion file."""
    return is_motion_file(file)


def plan_input(file: str, setup: Setup, *, conditioned: Conditioner = certify) -> Plan:
    """Plan a file, or standard input for `-`.

    Args:
        file: BML, FML, text (.txt, .md, .srt, .vtt, SSML), or a motion such as .bap or .bvh.
        setup: robot, style and options.
        conditioned: conditioner that brings desired motions within the limits.

    Raises:
        BmlError: the file does not exist, or the document is refused.
        ConfigError: the motion is invalid.
    """
    if is_motion(file):
        return plan_motion_file(file, setup)
    content = read_input(file)
    if is_spoken_file(file, content):
        return plan_plain_text(content, setup, source=document_name(file), conditioned=conditioned)
    return plan(content, setup, source=document_name(file), conditioned=conditioned)


def print_timeline(planned: Plan, lags: Sequence[StrokeLag], screen: Console) -> None:
    """Print a row for each performed behaviour with its sync points.

    Rows are in order of time, in block time [s].

    Args:
        planned: plan whose behaviours are printed.
        lags: lags of the strokes that are tied to words.
        screen: console to print on.
    """
    table = Table()
    for name in ("from", "to"):
        table.add_column(name, justify="right", no_wrap=True)
    for name in ("behaviour", "action", "sync points"):
        table.add_column(name)
    behaviours = {behaviour.id: behaviour for behaviour in planned.timeline.block.behaviours}
    lags_by_sync = {(lag.behaviour, lag.sync): lag for lag in lags}
    rows: dict[str, list[SyncTime]] = {}
    for sync in planned.syncs:
        rows.setdefault(sync.behaviour, []).append(sync)
    for name, syncs in rows.items():
        shown_syncs = [sync for sync in syncs if sync.sync not in COLUMN_SYNCS or _is_moved(sync)]
        sync_text = ", ".join(_format_sync(sync, lags_by_sync.get((name, sync.sync))) for sync in shown_syncs)
        times = (f"{syncs[0].planned:.2f}", f"{syncs[-1].planned:.2f}")
        table.add_row(*times, *map(quote_text, (name, _describe_behaviour(behaviours[name], planned), sync_text)))
    if rows:
        screen.print(table)


def _format_sync(sync: SyncTime, lag: StrokeLag | None) -> str:
    requested = f" (requested {sync.requested:.2f})" if _is_moved(sync) else ""
    fastest = "" if lag is None else f" (hand fastest at {lag.fastest:.2f})"
    return f"{sync.sync} {sync.planned:.2f}{requested}{fastest}"


def _is_moved(sync: SyncTime) -> bool:
    return abs(sync.planned - sync.requested) > SHIFT_TO_WARN


def _describe_behaviour(behaviour: Behaviour, planned: Plan) -> str:
    """Describe a behaviour: spoken words, or type, label, gesture entry and hands."""
    match behaviour.action:
        case Speech(script):
            words = " ".join(script.text.split())
            return f'"{words}"' if len(words) <= MAX_SPEECH_LENGTH else f'"{words[:MAX_SPEECH_LENGTH]}..."'
        case Gesture(lexeme, mode):
            description = f"{behaviour.type} {label(behaviour)}"
            body_parts = planned.keyframes.uses.get(behaviour.id, frozenset())
            hands = tuple(side for side in SIDES if f"{side}_hand" in body_parts)
            match = planned.setup.lexicon.find(lexeme, mode) if hands else None
            entry_text = "" if match is None or match.form.id == lexeme.lower() else f" as {match.form.id}"
            return f"{description}{entry_text}{HAND_LABELS[hands]}"
        case _:
            return f"{behaviour.type} {label(behaviour)}"

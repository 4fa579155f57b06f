"""`kinesic plan`: one document as a motion in a file, or as a timeline on the screen; nothing moves."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import click
from rich.console import Console
from rich.table import Table

from kinesic.bml.block import Behaviour, Block, BmlError, Gesture, Speech
from kinesic.bml.parse import parse
from kinesic.body.robot import SIDES, Side
from kinesic.cli.options import Planning, read_input
from kinesic.cli.plain_words import printable, printable_xml
from kinesic.cli.progress import show_stages
from kinesic.cli.summary import print_notices
from kinesic.cli.terminal import console, error_console, quote_text
from kinesic.controller.documents import read_block, write_bml, write_fml
from kinesic.controller.synchrony import StrokeLag, median_lag, planned_lags
from kinesic.files.output_file import check_file
from kinesic.intent.fml.author import is_fml
from kinesic.planning.bap import SUFFIX, read_bap
from kinesic.planning.imported_motion import plan_imported
from kinesic.planning.motion_files import check_motion_file, save_motion
from kinesic.planning.plan import Plan, plan_block
from kinesic.planning.setup import Setup
from kinesic.planning.syncs import SHIFT_TO_WARN, SyncTime
from kinesic.report.gltf.scene import SUFFIX as SCENE
from kinesic.report.gltf.scene import is_scene, save_scene
from kinesic.report.labels import label

ENDS = ("start", "end")  # sync points that have a column
WORDS = 30  # letters of what is said
HANDS: Mapping[tuple[Side, ...], str] = {
    (): "",
    ("l",): ", left hand",
    ("r",): ", right hand",
    ("l", "r"): ", both hands",
}
TEXT = ".txt"  # of a file with plain text, for which BML is written


def plan_file(file: str, planning: Planning, out: Path | None, force: bool, to: str) -> int:
    """Plans a document or a motion, and writes it to a file; without one, it prints what would happen when.

    To BML it is not planned: what it is as BML is printed.
    """
    if to == "bml":
        return _print_bml(file, planning.set_up())
    if out is not None:
        check_motion_file(out, also=SCENE)
        check_file(out, force=force)
    with show_stages() as stage:
        stage("planning")
        known = planning.set_up()
        planned = plan_motion(file, known) if is_motion(file) else plan_block(parse_document(file, known), known)
    lags = planned_lags(planned)
    if out is None:
        print_timeline(planned, lags, console())
    elif is_scene(out):
        save_scene(planned, out, force=force)
    else:
        save_motion(planned.trajectory, known.robot, out, force=force)
    print_notices(planned, error_console())
    middle = median_lag(lags)
    if middle is not None:
        click.echo(f"hands are fastest {middle:.2f} s from their words (median, strokes: {len(lags)})")
    click.echo(f"{planned.trajectory.duration:.2f} s, {len(planned.postures.postures)} keys")
    click.echo("nothing is written: --out motion.npz (.csv, .bap) would be" if out is None else f"motion: {out}")
    return 0


def _print_bml(file: str, known: Setup) -> int:
    """Prints the BML that is written for a plain text or FML; of BML, what it is."""
    read = read_input(file)
    if file.lower().endswith(TEXT):
        click.echo(printable_xml(write_bml(read.decode("utf-8", "replace"), known)), nl=False)
    elif is_fml(read):
        bml, unshown = write_fml(read, known, source=document_name(file))
        click.echo(printable_xml(bml), nl=False)
        for each in unshown:
            click.echo(f"not shown: {printable(each)}", err=True)
    else:
        raise BmlError(f"{document_name(file)}: it is BML already, or a motion; --to bml is for FML and plain text")
    return 0


def document_name(file: str) -> str:
    """Names a document as messages and reports have it."""
    return "stdin" if file == "-" else file


def is_motion(file: str) -> bool:
    """Says whether a document is a motion that was made elsewhere, and no BML."""
    return file.lower().endswith(SUFFIX)


def parse_document(file: str, known: Setup) -> Block:
    """Reads BML or FML from a file, or from standard input for `-`; of a plain text (.txt), the BML written for it.

    Raises:
        BmlError: there is no such file, or the document is refused.
    """
    read = read_input(file)
    if file.lower().endswith(TEXT):
        return parse_text(read.decode("utf-8", "replace"), known, source=file)
    return read_block(read, known, source=document_name(file))


def parse_text(text: str, known: Setup, *, source: str) -> Block:
    """Reads the BML that is written for a plain text.

    Args:
        text: that is said.
        known: says in which style, and with which seed.
        source: name of the text in messages and reports.
    """
    return parse(write_bml(text, known), source=source, dialect=known.dialect, performer=known.character)


def plan_motion(file: str, known: Setup) -> Plan:
    """Plans a motion from a file; nothing moves.

    Raises:
        ConfigError: there is no such file, or it is wrong.
    """
    return plan_imported(read_bap(Path(file), known.robot), known, source=file)


def print_timeline(planned: Plan, lags: Sequence[StrokeLag], screen: Console) -> None:
    """Prints a row for each behaviour that is performed, in time order, with all its sync points in block time [s].

    Args:
        planned: what is performed.
        lags: of its strokes that are tied to words.
        screen: to print on.
    """
    table = Table(box=None, header_style="bold")
    for name in ("from", "to"):
        table.add_column(name, justify="right", no_wrap=True)
    for name in ("behaviour", "does", "sync points"):
        table.add_column(name)
    known = {behaviour.id: behaviour for behaviour in planned.timeline.block.behaviours}
    tied = {(each.behaviour, each.sync): each for each in lags}
    rows: dict[str, list[SyncTime]] = {}
    for sync in planned.syncs:
        rows.setdefault(sync.behaviour, []).append(sync)
    for name, syncs in rows.items():
        shown = [sync for sync in syncs if sync.sync not in ENDS or _is_moved(sync)]
        between = ", ".join(_point(sync, tied.get((name, sync.sync))) for sync in shown)
        times = (f"{syncs[0].planned:.2f}", f"{syncs[-1].planned:.2f}")
        table.add_row(*times, *map(quote_text, (name, _does(known[name], planned), between)))
    if rows:
        screen.print(table)


def _point(sync: SyncTime, lag: StrokeLag | None) -> str:
    asked = f" (asked {sync.asked:.2f})" if _is_moved(sync) else ""
    fastest = "" if lag is None else f" (hand fastest at {lag.fastest:.2f})"
    return f"{sync.sync} {sync.planned:.2f}{asked}{fastest}"


def _is_moved(sync: SyncTime) -> bool:
    return abs(sync.planned - sync.asked) > SHIFT_TO_WARN


def _does(behaviour: Behaviour, planned: Plan) -> str:
    """What a behaviour is and does; of a gesture the entry of the lexicon and the hands, of a speech its words."""
    match behaviour.action:
        case Speech(script):
            words = " ".join(script.text.split())
            return f'"{words}"' if len(words) <= WORDS else f'"{words[:WORDS]}..."'
        case Gesture(lexeme, mode):
            asked = f"{behaviour.type} {label(behaviour)}"
            used = planned.keyframes.uses.get(behaviour.id, frozenset())
            hands = tuple(side for side in SIDES if f"{side}_hand" in used)
            found = planned.setup.lexicon.find(lexeme, mode) if hands else None
            entry = "" if found is None or found.form.id == lexeme.lower() else f" as {found.form.id}"
            return f"{asked}{entry}{HANDS[hands]}"
        case _:
            return f"{behaviour.type} {label(behaviour)}"

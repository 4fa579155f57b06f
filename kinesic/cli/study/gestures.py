"""`kinesic study make-gestures`: a study of gestures, from its page to what its answers say."""

import json
from collections.abc import Mapping
from pathlib import Path

import click
from rich.console import Console
from rich.table import Table

from kinesic.body.config import ConfigError
from kinesic.cli.options import Planning, read_input
from kinesic.cli.plain_words import printable
from kinesic.cli.progress import show_stages
from kinesic.cli.terminal import console, quote_text
from kinesic.files.output_folder import check_folder, new_folder
from kinesic.report.output import default_folder
from kinesic.report.report import Json
from kinesic.studies.gesture_perception.analysis import (
    CONFIDENCE,
    Habit,
    PreferenceResult,
    RecognitionResult,
    Share,
    analyse_preference,
    analyse_recognition,
    confusion_matrix,
    strange,
)
from kinesic.studies.gesture_perception.answers import read_gesture_answers
from kinesic.studies.gesture_perception.design import draw_meanings, draw_questions
from kinesic.studies.gesture_perception.page import write_gesture_page
from kinesic.studies.gesture_perception.stimuli import (
    StimulusPair,
    changed_setup,
    gesture_documents,
    plan_motions,
    plan_pairs,
)
from kinesic.studies.questionnaire.page import find_origin


def make_gesture_study(
    out: Path | None,
    force: bool,
    gestures: tuple[str, ...],
    count: int,
    conditions: tuple[str, ...],
    pairs: int,
    documents: tuple[Path, ...],
    post_to: str,
    planning: Planning,
) -> int:
    """Plans the gestures of a study, and writes the page that shows them and asks."""
    folder = out or default_folder("gesture-study")
    check_folder(folder, force=force)
    find_origin(post_to)
    known, seed = planning.set_up(), planning.options["seed"]
    for condition in conditions:
        changed_setup(known, condition)
    texts = _read_documents(documents)
    meanings = draw_meanings(known.lexicon, count, seed, gestures)
    alone = gesture_documents((meaning.gesture for meaning in meanings), known.lexicon)
    with new_folder(folder, force=force) as fresh, show_stages() as stage:
        stage("planning gestures")
        motions = plan_motions(alone, known, _tell)
        questions = draw_questions([meaning for meaning in meanings if meaning.gesture in motions], seed)
        stage("planning texts")
        spoken = plan_motions(texts, known, _tell)
        compared: list[StimulusPair] = []
        for k, condition in enumerate(dict.fromkeys(conditions) if pairs or spoken else ()):
            stage(f"planning with {condition}")
            own = plan_pairs(texts, spoken, known, condition, len(spoken))
            own += plan_pairs(alone, motions, known, condition, pairs, first=k * pairs)
            if not own:
                raise ConfigError(f"--compare {condition} changes nothing that anybody could see here")
            compared += own
        write_gesture_page(fresh / "index.html", known.robot, questions, motions, compared, post_to=post_to)
    click.echo(f"page: {folder / 'index.html'}")
    return 0


def _read_documents(paths: tuple[Path, ...]) -> dict[str, bytes]:
    """Reads documents by their names without endings, of which no two may be the same."""
    texts: dict[str, bytes] = {}
    for path in paths:
        if path.stem in texts:
            raise ConfigError(f"--text {path}: there is another text {path.stem}; name one differently")
        texts[path.stem] = read_input(str(path))
    return texts


def _tell(why: str) -> None:
    click.echo(printable(f"kinesic: {why}"), err=True)


def analyse_gestures(files: tuple[Path, ...], as_json: bool) -> int:
    """Prints what participants recognise and prefer."""
    answers = read_gesture_answers(files)
    recognised, preferred = analyse_recognition(answers.recognitions), analyse_preference(answers.preferences)
    habits = strange(answers)
    if as_json:
        names, counts = confusion_matrix(answers.recognitions)
        matrix: Json = {"gestures": list(names), "counts": [list(row) for row in counts]}
        document: dict[str, Json] = {
            "answers": len(answers.recognitions) + len(answers.preferences),
            "recognition": {**_recognition(recognised), "confusion": matrix} if recognised else None,
            "preference": _preference(preferred) if preferred else None,
            "choose_by_place": {person: _habit(habit) for person, habit in habits.items()},
        }
        click.echo(json.dumps(document, indent=1))
        return 0
    screen = console()
    if recognised:
        _print_recognition(recognised, screen)
    if preferred:
        _print_preference(preferred, screen)
    for person, habit in habits.items():
        times = f"{habit.share.hits} of {habit.share.total} times"
        screen.print(quote_text(f"participant {person} chose place {habit.place} {times} (p = {habit.share.p:.1g})"))
    return 0


def _print_recognition(result: RecognitionResult, screen: Console) -> None:
    overall = f"{_rate(result.overall)}, of {result.overall.total} answers of {len(result.participants)} participants"
    screen.print(f"recognised: {overall}; interval: {CONFIDENCE:.0%} (Wilson); p: as many by guessing (binomial)")
    table = Table("gesture", "answers", "recognised", "interval", "p", "taken for", box=None)
    for gesture, share in result.gestures.items():
        others = [each for each in result.confusions if each.shown == gesture]
        taken = ", ".join(f"{each.chosen} {each.count} of {each.offered}" for each in others)
        table.add_row(quote_text(gesture), *_cells(share), quote_text(taken))
    screen.print(table)


def _print_preference(result: PreferenceResult, screen: Console) -> None:
    screen.print("more natural as it is than with the changed setting; p: as far from one half by chance (binomial)")
    table = Table("changed", "answers", "as it is", "interval", "p", box=None)
    for condition, share in result.conditions.items():
        table.add_row(quote_text(condition), *_cells(share))
    screen.print(table)
    screen.print(f"the first of two was preferred: {_rate(result.first)}, p = {result.first.p:.3f}")


def _cells(share: Share) -> tuple[str, ...]:
    low, high = share.interval
    return f"{share.total}", f"{share.rate:.2f}", f"{low:.2f} to {high:.2f}", f"{share.p:.3f}"


def _rate(share: Share) -> str:
    low, high = share.interval
    return f"{share.rate:.2f} ({low:.2f} to {high:.2f})"


def _recognition(result: RecognitionResult) -> dict[str, Json]:
    return {
        "overall": _share(result.overall),
        "gestures": _shares(result.gestures),
        "confusions": [
            {"shown": each.shown, "chosen": each.chosen, "count": each.count, "offered": each.offered}
            for each in result.confusions
        ],
        "participants": _shares(result.participants),
    }


def _preference(result: PreferenceResult) -> dict[str, Json]:
    return {"conditions": _shares(result.conditions), "first_interval": _share(result.first)}


def _shares(shares: Mapping[str, Share]) -> dict[str, Json]:
    return {name: _share(share) for name, share in shares.items()}


def _share(share: Share) -> dict[str, Json]:
    return {
        "share": share.rate,
        "hits": share.hits,
        "answers": share.total,
        "interval": list(share.interval),
        "p": share.p,
    }


def _habit(habit: Habit) -> dict[str, Json]:
    return {"place": habit.place, **_share(habit.share)}

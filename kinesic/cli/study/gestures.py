"""Verb `kinesic study make-gestures`: perception study of gestures."""

import json
from pathlib import Path

import click

from kinesic.body.config import ConfigError
from kinesic.cli.options import Planning, read_input
from kinesic.cli.plain_words import printable
from kinesic.cli.progress import show_stages
from kinesic.cli.screen.console import Console
from kinesic.cli.screen.table import Table
from kinesic.cli.study.fractions import format_cells, format_rate, fraction_to_json, fractions_to_json
from kinesic.cli.study.options import GestureStudyContent, StudyOutput
from kinesic.cli.study.systems import matches_to_json, print_matches, print_ratings, ratings_to_json
from kinesic.cli.terminal import console, quote_text
from kinesic.files.output_folder import check_folder, new_folder
from kinesic.report.output import default_folder
from kinesic.report.report import Json
from kinesic.studies.gesture_perception.analysis import (
    CONFIDENCE_LEVEL,
    Habit,
    PreferenceResult,
    RecognitionResult,
    analyse_matches,
    analyse_preference,
    analyse_recognition,
    confusion_matrix,
    find_position_choosers,
)
from kinesic.studies.gesture_perception.answers import read_gesture_answers
from kinesic.studies.gesture_perception.design import draw_meanings, draw_questions
from kinesic.studies.gesture_perception.elo import rate_systems
from kinesic.studies.gesture_perception.page import write_gesture_page
from kinesic.studies.gesture_perception.stimuli import (
    StimulusPair,
    changed_setup,
    gesture_documents,
    plan_motions,
    plan_pairs,
)
from kinesic.studies.questionnaire.page import find_origin


def make_gesture_study(output: StudyOutput, content: GestureStudyContent, planning: Planning) -> int:
    """Plan the gestures of a study and write its questionnaire page."""
    folder, pairs = output.out or default_folder("gesture-study"), content.pairs
    check_folder(folder, force=output.force)
    find_origin(output.post_to)
    setup, seed = planning.set_up(), planning.options["seed"]
    for condition in content.conditions:
        changed_setup(setup, condition)
    texts = _read_documents(content.documents)
    meanings = draw_meanings(setup.lexicon, content.count, seed, content.gestures)
    gesture_blocks = gesture_documents((meaning.gesture for meaning in meanings), setup.lexicon)
    with new_folder(folder, force=output.force) as temporary, show_stages() as stage:
        stage("planning gestures")
        motions = plan_motions(gesture_blocks, setup, _warn)
        questions = draw_questions([meaning for meaning in meanings if meaning.gesture in motions], seed)
        stage("planning texts")
        text_motions = plan_motions(texts, setup, _warn)
        stimulus_pairs: list[StimulusPair] = []
        for k, condition in enumerate(dict.fromkeys(content.conditions) if pairs or text_motions else ()):
            stage(f"planning with {condition}")
            new_pairs = plan_pairs(texts, text_motions, setup, condition, len(text_motions))
            new_pairs += plan_pairs(gesture_blocks, motions, setup, condition, pairs, first=k * pairs)
            if not new_pairs:
                raise ConfigError(f"--compare {condition} changes no gesture visibly")
            stimulus_pairs += new_pairs
        page = temporary / "index.html"
        write_gesture_page(page, setup.robot, questions, motions, stimulus_pairs, post_to=output.post_to)
    click.echo(f"page: {folder / 'index.html'}")
    return 0


def _read_documents(paths: tuple[Path, ...]) -> dict[str, bytes]:
    """Read documents by file stem, refusing duplicate stems."""
    texts: dict[str, bytes] = {}
    for path in paths:
        if path.stem in texts:
            raise ConfigError(f"--text {path}: another text is named {path.stem}; rename one of them")
        texts[path.stem] = read_input(str(path))
    return texts


def _warn(message: str) -> None:
    click.echo(printable(f"kinesic: {message}"), err=True)


def analyse_gestures(files: tuple[Path, ...], as_json: bool) -> int:
    """Print the participants' recognition rates and preferences."""
    answers = read_gesture_answers(files)
    recognised, preferred = analyse_recognition(answers.recognitions), analyse_preference(answers.preferences)
    matched, rated = analyse_matches(answers.matches), rate_systems(answers.pair_choices, CONFIDENCE_LEVEL)
    habits = find_position_choosers(answers)
    if as_json:
        names, counts = confusion_matrix(answers.recognitions)
        matrix: Json = {"gestures": list(names), "counts": [list(row) for row in counts]}
        document: dict[str, Json] = {
            "answers": sum(map(len, (answers.recognitions, answers.preferences, answers.matches, answers.realisms))),
            "recognition": {**_recognition_to_json(recognised), "confusion": matrix} if recognised else None,
            "preference": _preference_to_json(preferred) if preferred else None,
            "mismatching": matches_to_json(matched) if matched else None,
            "elo": ratings_to_json(rated) if rated else None,
            "choose_by_place": {person: _habit_to_json(habit) for person, habit in habits.items()},
        }
        click.echo(json.dumps(document, indent=1))
        return 0
    screen = console()
    if recognised:
        _print_recognition(recognised, screen)
    if preferred:
        _print_preference(preferred, screen)
    if matched:
        print_matches(matched, screen)
    if rated:
        print_ratings(rated, screen)
    for person, habit in habits.items():
        times = f"{habit.frequency.hits} of {habit.frequency.total} times"
        screen.print(
            quote_text(f"participant {person} chose position {habit.place} {times} (p = {habit.frequency.p:.1g})")
        )
    return 0


def _print_recognition(result: RecognitionResult, screen: Console) -> None:
    overall = (
        f"{format_rate(result.overall)}, of {result.overall.total} answers of {len(result.participants)} participants"
    )
    screen.print(
        f"recognised: {overall}; interval: {CONFIDENCE_LEVEL:.0%} (Wilson); p: probability by guessing (binomial)"
    )
    table = Table("gesture", "answers", "recognised", "interval", "p", "confused with")
    for gesture, fraction in result.gestures.items():
        confusions = [confusion for confusion in result.confusions if confusion.shown == gesture]
        confused = ", ".join(f"{confusion.chosen} {confusion.count} of {confusion.offered}" for confusion in confusions)
        table.add_row(quote_text(gesture), *format_cells(fraction), quote_text(confused))
    screen.print(table)


def _print_preference(result: PreferenceResult, screen: Console) -> None:
    screen.print(
        "fraction that finds the unchanged gesture more natural; p: deviation from one half by chance (binomial)"
    )
    table = Table("changed", "answers", "unchanged", "interval", "p")
    for condition, fraction in result.conditions.items():
        table.add_row(quote_text(condition), *format_cells(fraction))
    screen.print(table)
    screen.print(f"the first of two gestures was preferred: {format_rate(result.first)}, p = {result.first.p:.3f}")


def _recognition_to_json(result: RecognitionResult) -> dict[str, Json]:
    return {
        "overall": fraction_to_json(result.overall),
        "gestures": fractions_to_json(result.gestures),
        "confusions": [
            {
                "shown": confusion.shown,
                "chosen": confusion.chosen,
                "count": confusion.count,
                "offered": confusion.offered,
            }
            for confusion in result.confusions
        ],
        "participants": fractions_to_json(result.participants),
    }


def _preference_to_json(result: PreferenceResult) -> dict[str, Json]:
    return {"conditions": fractions_to_json(result.conditions), "first_interval": fraction_to_json(result.first)}


def _habit_to_json(habit: Habit) -> dict[str, Json]:
    return {"place": habit.place, **fraction_to_json(habit.frequency)}

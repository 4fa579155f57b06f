"""Verb `kinesic study make-speech`: mismatching test of speech and motion."""

from pathlib import Path

import click

from kinesic.body.config import ConfigError
from kinesic.cli.options import Planning, read_input
from kinesic.cli.progress import show_stages
from kinesic.cli.study.options import SpeechStudyContent, StudyOutput
from kinesic.files.output_folder import check_folder, new_folder
from kinesic.report.output import default_folder
from kinesic.session.documents import is_spoken_file
from kinesic.studies.gesture_perception.power import convert_to_points, find_detectable_rate
from kinesic.studies.gesture_perception.speech import plan_spoken_motions
from kinesic.studies.gesture_perception.speech_page import (
    MATCHES_PER_SYSTEM,
    PAIRS_PER_COMPARISON,
    write_speech_page,
)
from kinesic.studies.questionnaire.page import find_origin


def make_speech_study(output: StudyOutput, content: SpeechStudyContent, planning: Planning) -> int:
    """Plan texts with several systems and write the speech study's page."""
    folder = output.out or default_folder("speech-study")
    check_folder(folder, force=output.force)
    find_origin(output.post_to)
    texts = _read_texts(content.documents)
    setup, systems = planning.set_up(), tuple(dict.fromkeys(content.conditions))
    with new_folder(folder, force=output.force) as temporary, show_stages() as stage:
        spoken = plan_spoken_motions(texts, setup, systems, lambda system: stage(f"planning with {system}"))
        count = write_speech_page(temporary / "index.html", setup.robot, spoken, post_to=output.post_to)
    click.echo(f"{len(texts)} texts, {len(systems) + 1} systems, {count} trials for each participant")
    if all(item.sound is None for item in spoken):
        click.echo("warning: the voice is silent, so that participants read the words: --voice espeak", err=True)
    _print_power(content.participants, len(texts), bool(systems))
    click.echo(f"page: {folder / 'index.html'}")
    return 0


def _print_power(participants: int, text_count: int, is_compared: bool) -> None:
    """Print the smallest effects detectable with the planned number of participants."""
    answers = participants * min(text_count, MATCHES_PER_SYSTEM)
    rate = find_detectable_rate(answers)
    click.echo(
        f"{participants} participants give {answers} answers on the speech of each system: "
        f"a rate of {rate:.2f} is shown with a power of 80 % (guessing: 0.50)"
    )
    if is_compared:
        answers = participants * min(text_count, PAIRS_PER_COMPARISON)
        rate = find_detectable_rate(answers)
        click.echo(
            f"and {answers} on each pair of systems: a preference of {rate:.2f} is shown, "
            f"{convert_to_points(rate):.0f} points of Elo"
        )


def _read_texts(paths: tuple[Path, ...]) -> dict[str, tuple[str | bytes, bool]]:
    """Read texts by file stem, with whether each is plain text.

    Raises:
        ConfigError: two files have the same stem.
    """
    texts: dict[str, tuple[str | bytes, bool]] = {}
    for path in paths:
        if path.stem in texts:
            raise ConfigError(f"--text {path}: another text is named {path.stem}; rename one of them")
        content = read_input(str(path))
        texts[path.stem] = (content, is_spoken_file(str(path), content))
    return texts

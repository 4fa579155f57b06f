"""Declarations of the verbs `kinesic study`."""

from pathlib import Path

import click

from kinesic.cli.completion import GESTURE_NAME
from kinesic.cli.help_pages import VerbGroup
from kinesic.cli.options import FORCE_HELP, group_options, implemented_by, planning_options
from kinesic.cli.study.options import GestureStudyContent, SpeechStudyContent, StudyOutput
from kinesic.face.render.presets import QUALITY_PRESETS

DEFAULT_COMPARISONS = ("effort=0", "whole_body=0", "power=-1")  # style settings compared with the unchanged style
COMPARE_HELP = (
    "Setting, as for --set, or idle=0, variation=0: gestures are compared with and without it. Repeatable "
    f"(default: {', '.join(DEFAULT_COMPARISONS)})."
)
TEXT_HELP = "BML document to compare like a gesture, with its words as captions. Repeatable."


@click.group("study", cls=VerbGroup)
def study_verbs() -> None:
    """Make and analyse perception studies of the face and of gestures."""


@study_verbs.command("make")
@click.option("--out", type=click.Path(path_type=Path), help="Folder of the study (default: out/study-TIME).")
@click.option("--force", is_flag=True, help=FORCE_HELP)
@click.option(
    "--size",
    type=click.IntRange(64, 1024),
    default=384,
    show_default=True,
    help="Side length of the pictures in pixels.",
)
@click.option(
    "--preset", type=click.Choice(list(QUALITY_PRESETS)), default="normal", show_default=True, help="Rendering quality."
)
@click.option("--post-to", default="", metavar="URL", help="URL that also receives the answers, as CSV.")
@implemented_by("study.face:make_study")
def _make_study() -> None:
    """Render all 128 faces of a study and write its page."""


@study_verbs.command("make-gestures")
@group_options(
    "output",
    StudyOutput,
    click.option(
        "--out", type=click.Path(path_type=Path), help="Folder of the study (default: out/gesture-study-TIME)."
    ),
    click.option("--force", is_flag=True, help=FORCE_HELP),
)
@group_options(
    "content",
    GestureStudyContent,
    click.option(
        "--gesture",
        "gestures",
        type=GESTURE_NAME,
        multiple=True,
        metavar="ID",
        help="Id of a gesture to include. Repeatable.",
    ),
    click.option(
        "--count",
        type=click.IntRange(6),
        default=48,
        show_default=True,
        help="Number of gestures drawn at random if none is named.",
    ),
    click.option(
        "--compare", "conditions", multiple=True, metavar="NAME=VALUE", default=DEFAULT_COMPARISONS, help=COMPARE_HELP
    ),
    click.option(
        "--pairs",
        type=click.IntRange(0),
        default=12,
        show_default=True,
        help="Number of gestures compared for each setting.",
    ),
    click.option("--text", "documents", multiple=True, type=click.Path(path_type=Path), metavar="FILE", help=TEXT_HELP),
)
@click.option("--post-to", default="", metavar="URL", help="URL that also receives the answers, as CSV.")
@planning_options
@implemented_by("study.gestures:make_gesture_study")
def _make_gesture_study() -> None:
    """Plan gestures and write the questionnaire page of a gesture study.

    The page asks which of six meanings a gesture has, and which of two motions is more natural.
    """


@study_verbs.command("make-speech")
@group_options(
    "output",
    StudyOutput,
    click.option(
        "--out", type=click.Path(path_type=Path), help="Folder of the study (default: out/speech-study-TIME)."
    ),
    click.option("--force", is_flag=True, help=FORCE_HELP),
)
@group_options(
    "content",
    SpeechStudyContent,
    click.option(
        "--text",
        "documents",
        multiple=True,
        required=True,
        type=click.Path(path_type=Path),
        metavar="FILE",
        help="Text or BML document with speech, preferably of similar length. Repeatable; at least two.",
    ),
    click.option(
        "--compare",
        "conditions",
        multiple=True,
        metavar="NAME=VALUE",
        help="Setting of an additional system, as for --set, or idle=0, variation=0. Repeatable.",
    ),
    click.option(
        "--participants",
        type=click.IntRange(1, 100_000),
        default=40,
        show_default=True,
        help="Planned number of participants, for the estimate of power.",
    ),
)
@click.option("--post-to", default="", metavar="URL", help="URL that also receives the answers, as CSV.")
@planning_options
@implemented_by("study.speech:make_speech_study")
def _make_speech_study() -> None:
    """Plan texts and write the questionnaire page of a speech study.

    The page asks which of two speeches belongs to a motion (the mismatching test of GENEA), and which of two systems
    moves more naturally.
    """


@study_verbs.command("analyse")
@click.argument("files", nargs=-1, required=True, type=click.Path(path_type=Path))
@click.option("--json", "as_json", is_flag=True, help="Print the tables as JSON.")
@implemented_by("study.analyse:analyse_study")
def _analyse_study() -> None:
    """Analyse FILES, the answers (CSV) of all participants in a perception study."""

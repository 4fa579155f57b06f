"""The command line: every verb with its arguments and options; what does it is imported when it is to be done."""

from pathlib import Path

import click

from kinesic.bench import PARTS
from kinesic.body.config import names_of
from kinesic.cli.effects import effects, face_view
from kinesic.cli.film_options import film_options
from kinesic.cli.many.workers import workers
from kinesic.cli.options import (
    FORCE_HELP,
    done_by,
    expression,
    force_option,
    output,
    performers,
    picture_file,
    planning,
    robot_option,
    twin_options,
)
from kinesic.face.render.presets import PRESETS
from kinesic.sim.fitting.parameters import DEFAULT, FIGURES
from kinesic.sim.log import FORMAT
from kinesic.version import __version__

ON_HELP = (
    "Who performs, with commas between: twin (always first), servos, face (in a window where there is a display). "
    "Space stops the servos, Ctrl-C folds them to rest."
)
COMPARED = ("effort=0", "whole_body=0", "power=-1")
COMPARE_HELP = (
    "A setting, as for --set, or idle=0, variation=0: gestures are compared with and without it; repeat it "
    f"(default: {', '.join(COMPARED)})."
)
TEXT_HELP = "BML that is compared as gestures are, with its words as captions; repeat it."
FREE_HELP = "Figures that may differ from the data sheets; repeat it. mass only without stall."

lexicon_option = click.option("--lexicon", type=click.Path(path_type=Path), help="TOML, or Greta's gestuary XML.")
report_output = output(
    "Folder of the report (default: out/NAME-TIME), or scene.glb: the performance as glTF.",
    FORCE_HELP,
    "Prints the report as JSON.",
    film_options,
)
player_option = click.option("--robot", default="upper22", help="Who plays them.")


@click.group(context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__)
def kinesic() -> None:
    """Performs BML (Behavior Markup Language) on humanoids with servos."""


@kinesic.command("bench")
@click.argument("part", type=click.Choice([*PARTS, "all"]))
@click.option("--matrix", is_flag=True, help="Of bus: the whole fault matrix instead, for every driver.")
@click.option(
    "--style",
    "styles",
    multiple=True,
    type=click.Choice(names_of("style")),
    help="Of naturalness: gestures in this manner alone; repeat it.",
)
@click.option(
    "--capture",
    metavar="FOLDER",
    type=click.Path(path_type=Path),
    help="Of naturalness: a folder of captured gestures (.skm, .sk) that are measured.",
)
@click.option("--json", "as_json", is_flag=True, help="Prints a list of figures as JSON.")
@click.option("--plots", type=click.Path(file_okay=False, path_type=Path), help="Draws into this folder, too.")
@click.option("--out", type=click.Path(path_type=Path), help="Folder of the figures, for `kinesic results`.")
@click.option("--force", is_flag=True, help="Replaces what is there: pictures, or a folder that kinesic has made.")
@workers
@done_by("bench:print_figures")
def _bench() -> None:
    """Measures PART; timings are medians in a warm process."""


@kinesic.command("doctor")
@done_by("doctor:examine_machine")
def _doctor() -> None:
    """Shows what works here and what would mend the rest."""


@kinesic.command("face")
@expression
@click.option("--bml", metavar="FILE", help="A document whose face is performed; - for standard input.")
@picture_file
@face_view
@effects
@click.option("--sheet", is_flag=True, help="Every action unit low and high, with and without wrinkles.")
@planning
@done_by("face:draw_face")
def _face() -> None:
    """Draws the face: a still, a film, a contact sheet, or a window where there is a display and no --out."""


@kinesic.group()
def gestures() -> None:
    """Lists, shows and draws the gestures of the lexicon."""


@gestures.command("list")
@lexicon_option
@player_option
@click.option("--category", help="Only of this one.")
@click.option("--json", "as_json", is_flag=True, help="Prints a vocabulary in JSON, for a planner or a language model.")
@done_by("gestures:list_gestures")
def _list_gestures() -> None:
    """Lists all gestures."""


@gestures.command("show")
@click.argument("lexeme")
@lexicon_option
@done_by("gestures:show_gesture")
def _show_gesture() -> None:
    """Shows what LEXEME becomes: the gesture or its substitute, key by key."""


@gestures.command("render")
@click.argument("lexeme", required=False)
@click.option("--all", "whole", is_flag=True, help="Draws a contact sheet of all gestures, in lines.")
@click.option("--turntable", is_flag=True, help="Films the robot in its stroke from all around: X.webp or X.mp4.")
@click.option("--drawn", is_flag=True, help="Draws lines, as where there is no OpenGL, and for X.svg and X.pdf.")
@click.option("--out", required=True, type=click.Path(path_type=Path), help="The picture or film, such as X.png.")
@force_option
@lexicon_option
@player_option
@done_by("gestures:render_gestures")
def _render_gestures() -> None:
    """Draws LEXEME as key postures side by side, its stroke from all around, or all gestures at their strokes."""


@kinesic.command("perform")
@click.argument("file")
@planning
@performers(ON_HELP)
@twin_options
@report_output
@done_by("several_robots:perform_document")
def _perform() -> None:
    """Performs FILE (BML, FML, a .bap motion, or - for BML from standard input) and writes a report.

    On servos it is performed after the twin has performed it without a failed check. --robot A,B performs it with
    several robots, and films them side by side.
    """


@kinesic.command("plan")
@click.argument("file")
@planning
@click.option(
    "--out", type=click.Path(path_type=Path), help="motion.npz, .csv or .bap, or scene.glb; without it, a timeline."
)
@force_option
@click.option("--to", type=click.Choice(["motion", "bml"]), default="motion", help="bml: prints it for FML or a text.")
@done_by("plan:plan_file")
def _plan() -> None:
    """Plans FILE (BML, FML, a .bap motion, or - for BML from standard input) and writes the motion.

    Without --out nothing is written: it prints what would happen when, and what could not be done as asked.
    """


@kinesic.group()
def robots() -> None:
    """Lists, shows, checks and imports robots."""


@robots.command("list")
@done_by("robots:list_robots")
def _list_robots() -> None:
    """Lists the robots that come with kinesic."""


@robots.command("show")
@click.argument("robot", default="upper22")
@done_by("robots:show_robot")
def _show_robot() -> None:
    """Shows the hinges of ROBOT: range, servo, limits."""


@robots.command("check")
@click.argument("robot", default="upper22")
@done_by("robots:assess_robot")
def _assess_robot() -> None:
    """Computes static torque ratios, workspace and clearance of ROBOT from its model."""


@robots.command("import")
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--out", type=click.Path(path_type=Path), help="The robot's TOML (default: FILE's name, here).")
@force_option
@done_by("robots:import_robot")
def _import_robot() -> None:
    """Maps the hinges of an MJCF or URDF humanoid, and writes a robot's TOML to edit."""


@kinesic.command("say")
@click.argument("text")
@planning
@performers(ON_HELP)
@twin_options
@report_output
@click.option("--to", type=click.Choice(["performance", "bml"]), default="performance", help="bml: only prints it.")
@done_by("perform:say_text")
def _say() -> None:
    """Says TEXT with gestures, head, face and gaze for what it means; each has its reason in the BML.

    With - as TEXT standard input is said as it comes, phrase by phrase, live and without a report.
    """


@kinesic.group()
def study() -> None:
    """Asks people what they see in the face, and in gestures."""


@study.command("make")
@click.option("--out", type=click.Path(path_type=Path), help="Folder of the study (default: out/study-TIME).")
@click.option("--force", is_flag=True, help=FORCE_HELP)
@click.option("--size", type=click.IntRange(64, 1024), default=384, show_default=True, help="Pixels along a side.")
@click.option("--preset", type=click.Choice(list(PRESETS)), default="normal", show_default=True)
@click.option("--post-to", default="", metavar="URL", help="Where answers are sent too, as CSV.")
@done_by("study.face:make_study")
def _make_study() -> None:
    """Draws all 128 faces and writes the page that shows them and asks."""


@study.command("make-gestures")
@click.option("--out", type=click.Path(path_type=Path), help="Folder of the study (default: out/gesture-study-TIME).")
@click.option("--force", is_flag=True, help=FORCE_HELP)
@click.option("--gesture", "gestures", multiple=True, metavar="ID", help="One of the study, by its id; repeat it.")
@click.option("--count", type=click.IntRange(6), default=48, show_default=True, help="Gestures that are drawn instead.")
@click.option("--compare", "conditions", multiple=True, metavar="NAME=VALUE", default=COMPARED, help=COMPARE_HELP)
@click.option("--pairs", type=click.IntRange(0), default=12, show_default=True, help="Gestures compared for each.")
@click.option("--text", "documents", multiple=True, type=click.Path(path_type=Path), metavar="FILE", help=TEXT_HELP)
@click.option("--post-to", default="", metavar="URL", help="Where answers are sent too, as CSV.")
@planning
@done_by("study.gestures:make_gesture_study")
def _make_gesture_study() -> None:
    """Plans gestures and writes the page that plays them and asks: which of six meanings, and which is more natural."""


@study.command("analyse")
@click.argument("files", nargs=-1, required=True, type=click.Path(path_type=Path))
@click.option("--json", "as_json", is_flag=True, help="Prints the tables as JSON.")
@done_by("study.analyse:analyse_study")
def _analyse_study() -> None:
    """Says what is in FILES, the answers (CSV) of all participants in a study of the face or of gestures."""


@kinesic.group()
def twin() -> None:
    """Fits the twin to a robot."""


@twin.command(
    "fit",
    epilog=f"LOG is an {FORMAT}. `kinesic perform` writes one of the twin, measured.npz, beside its report. Quick and "
    "wide motion of every hinge tells most; 5 to 20 s are enough.",
)
@click.argument("log", type=click.Path(path_type=Path))
@robot_option
@click.option("--free", multiple=True, type=click.Choice(FIGURES), default=DEFAULT, show_default=True, help=FREE_HELP)
@click.option("--out", type=click.Path(path_type=Path), help="TOML of factors, for --twin.")
@force_option
@click.option("--json", "as_json", is_flag=True, help="Prints the estimates as JSON.")
@done_by("twin:fit_twin")
def _fit_twin() -> None:
    """Fits servo factors to LOG, and says which of them it cannot tell."""

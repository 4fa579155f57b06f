"""Reference page of all TOML files that users write."""

from dataclasses import dataclass

import msgspec
from struct_tables import describe_type, key_table, nested_tables, title_of

from kinesic.body.calibration import Calibration
from kinesic.body.impact_policy import ImpactFile
from kinesic.body.robot_schema import RobotFile, ServoTable
from kinesic.expressivity.lexicon.gesture_card import GestureCard
from kinesic.expressivity.lexicon.toml_file import GestureFile
from kinesic.expressivity.style.style import StyleTable
from kinesic.hardware.protocol.servo_map import BusTable
from kinesic.hardware.virtual.faults import FaultFile
from kinesic.sim.servo_factors import Factors

HEAD = """# TOML files

Styles, gestures, robots and several other inputs of kinesic are TOML files. This page lists all keys of each kind of
file, with their types, defaults and meanings. A key without a default is marked as required.

If a file contains an unknown key, a wrong type or a number that is not finite, kinesic refuses it. The error names the
file, the place and a valid key. The page is generated from the schemas that kinesic reads.
"""


@dataclass(frozen=True, eq=False)
class Document:
    """One kind of TOML file, with the structs of its tables."""

    title: str
    use: str
    tables: tuple[type[msgspec.Struct], ...]
    note: str = ""


STYLE_EXAMPLE = """For example, this style is slow and soft, and its head moves less than its arms:

```toml
spatial = -0.1
temporal = -0.4
fluidity = 0.7
power = -0.3
tension = -0.6
repetition = -0.2
activation = -0.2
openness = 0.3

[head]
spatial = -0.2

[standing]
trunk = { tilt = -1 }
rest = "hands_folded_low"
```"""

CALIBRATION_EXAMPLE = """For example, this calibration sets the zero of one hinge and the direction of another:

```toml
robot = "upper22"

[zero_ticks]
l_elbow_flexion = 2332

[inverted]
l_wrist_pivot = true
```"""

FACTORS_EXAMPLE = """For example, these factors make all servos weaker and all messages late:

```toml
stall = 0.8
latency = 0.02

[servos.xm430_w350]
gain = 0.9
```"""

FAULTS_NOTE = """For example, this plan damages one answer in a hundred, and cuts the power of servo 3 once:

```toml
[[fault]]
kind = "corrupt"
rate = 0.01

[[fault]]
kind = "reboot"
servos = [3]
start = 2.0
```

| kind | effect | `value`, with its default |
|---|---|---|
| `corrupt` | one byte of a message changes | |
| `drop` | one byte of a message is lost | |
| `truncate` | the end of a message is lost | |
| `duplicate` | a message arrives twice | |
| `noise` | random bytes arrive before a message | largest number of bytes: 8 |
| `lost` | a whole message is lost | |
| `late` | an answer arrives late | delay: 0.012 s |
| `silent` | a servo does not answer | |
| `reboot` | a servo loses its power for a moment | time without power: 0.13 s |
| `alert` | a servo reports a hardware error | bits of the register Hardware Error Status: 32, overload |
| `overheat` | a servo becomes hotter | heating rate: 2 K/s |
| `undervoltage` | the supply voltage of a servo falls | supply voltage: 9 V |
| `watchdog` | the bus watchdog of a servo stops it | |
| `duplicate_id` | a second servo has the same id | model number of the second servo: 0, the same model |
| `wrong_model` | a servo reports the number of another model | model number: 1060, XL430 |
| `old_firmware` | a servo has an old firmware | version of the firmware: 41 |
| `unplug` | the adapter is unplugged | |"""


DOCUMENTS = (
    Document(
        "Styles",
        "Read by `--style FILE.toml`; the built-in ones are in `kinesic/configs/styles/`. `kinesic new style "
        "NAME` writes one. Parameters are in [-1, 1], `openness` in [0, 1]; "
        "[expressivity](../explanation/expressivity.md) shows the effect of each. The tables `gesture`, "
        "`head`, `torso` and `face` override parameters for one modality.",
        (StyleTable,),
        STYLE_EXAMPLE,
    ),
    Document(
        "Gestures",
        "Read by `--lexicon FILE.toml`, and from `kinesic/configs/gestures/`. `kinesic new gesture NAME` "
        "writes an example. [Gesture files](gesture-files.md) explains sectors, direction words and paths, and "
        "[Write a gesture](../how-to/write-a-gesture.md#hand-shapes) hand shapes.",
        (GestureFile,),
    ),
    Document(
        "Cards of gesture folders",
        "The file `card.toml` of a shared gesture folder. `kinesic capture import` writes it, and "
        "`kinesic gestures install` reads it.",
        (GestureCard,),
    ),
    Document(
        "Robots",
        "Read by `--robot FILE.toml`; the built-in ones are in `kinesic/configs/robots/`. `kinesic robots "
        "import` writes one from MJCF or URDF, `kinesic new robot NAME` one from a built-in robot, and "
        "`kinesic robots check FILE` checks it. In all frames, x points forward, y left and z up. At angle 0 of "
        "all hinges, the arms hang down, with the palms at the thighs.",
        (RobotFile, BusTable),
    ),
    Document(
        "Servo models",
        "The file `kinesic/configs/servos.toml` has one table for each model, `[xm540_w270]`. A robot's "
        "`[servos.NAME]` adds models with the same keys. Values are those of the output shaft at `volt`.",
        (ServoTable,),
    ),
    Document(
        "Limits of contacts",
        "Read by `[audience] limits` of a robot's file; the built-in one is `kinesic/configs/impacts.toml`. It "
        "describes parts of a person's body, and a policy for each audience. [Limit contacts with people]"
        "(../how-to/limit-contacts.md) shows how to use it.",
        (ImpactFile,),
    ),
    Document(
        "Calibrations",
        "Written by `kinesic servos calibrate` next to the robot's file, as `NAME.calibration.toml`. For a "
        "built-in robot it is in the user's configuration folder, `~/.config/kinesic`.",
        (Calibration,),
        CALIBRATION_EXAMPLE,
    ),
    Document(
        "Twin factors",
        "Read by `--twin FILE.toml`, and written by `kinesic twin fit` and `--learn FILE`. All factors "
        "multiply the values of the robot's file. A table `[servos.MODEL]` replaces the factors of one servo "
        "model.",
        (Factors,),
        FACTORS_EXAMPLE,
    ),
    Document(
        "Fault plans",
        "Read by `kinesic servos simulate --faults FILE.toml`. Each `[[fault]]` disturbs a virtual bus or its servos.",
        (FaultFile,),
        FAULTS_NOTE,
    ),
)

OTHER_KINDS = {RobotFile: {"bus": f"list of {describe_type(BusTable)}"}}  # tables that the hardware package reads


def write_page() -> str:
    """Return the page with the tables of all documents."""
    lines = [HEAD, "| file | read or written by |", "|---|---|"]
    for document in DOCUMENTS:
        lines.append(f"| [{document.title}](#{_anchor(document.title)}) | {document.use.split('. ')[0].rstrip('.')} |")
    lines.append("| Targets | Read by `--targets FILE.toml`: lines `name = [x, y, z]`, positions in the world [m] |")
    for document in DOCUMENTS:
        lines += ["", f"## {document.title}", "", document.use, ""]
        lines += [document.note, ""] if document.note else []
        for table in list_tables(document):
            lines += [f"### {title_of(table)}", "", *_about(table), *key_table(table, OTHER_KINDS.get(table, {})), ""]
    return "\n".join(lines).rstrip() + "\n"


def list_tables(document: Document) -> list[type[msgspec.Struct]]:
    """Return all structs of a document, except those of servo models."""
    found = dict.fromkeys(table for root in document.tables for table in nested_tables(root))
    return [table for table in found if table is not ServoTable or document.tables == (ServoTable,)]


def _about(table: type[msgspec.Struct]) -> list[str]:
    return [line for paragraph in (table.__doc__ or "").split("\n\n") for line in (" ".join(paragraph.split()), "")]


def _anchor(title: str) -> str:
    return title.lower().replace(" ", "-")

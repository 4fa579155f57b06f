"""Examples of command lines at the end of each help page."""

from collections.abc import Mapping

import click

VERB_EXAMPLES: Mapping[str, tuple[str, ...]] = {
    "bench": ("kinesic bench ik", "kinesic bench naturalness --style joyful --json"),
    "capture graph": ("kinesic capture graph mine",),
    "capture import": ('kinesic capture import clips --out mine --licence "CC BY 4.0"',),
    "certify": ("kinesic certify motion.bvh --robot upper36 --out motion.npz", "kinesic certify motion.csv --check"),
    "completion": ("kinesic completion bash >> ~/.bashrc", "kinesic completion fish"),
    "demo": ("kinesic demo", "kinesic demo --robot human --style joyful --out greeting"),
    "doctor": ("kinesic doctor",),
    "export": ("kinesic export welcome --to mcap", "kinesic export welcome --to lerobot --performed"),
    "face": ("kinesic face --emotion joy --out joy.png", "kinesic face --bml welcome --out face.webp"),
    "gestures find": (
        "kinesic gestures find weigh two things",
        "kinesic gestures find hand to the temple",
        "kinesic gestures find big --category iconic --json",
    ),
    "gestures install": ("kinesic gestures install mine.zip", "kinesic gestures install mine --library shared"),
    "gestures list": ("kinesic gestures list --category emblem", "kinesic gestures list --json"),
    "gestures remove": ("kinesic gestures remove mine",),
    "gestures render": ("kinesic gestures render offer --out offer.png", "kinesic gestures render --all --out all.png"),
    "gestures show": ("kinesic gestures show offer",),
    "mcp": ("kinesic mcp --robot upper36", "kinesic mcp --connect localhost:8864"),
    "new": ("kinesic new gesture my_offer", "kinesic new style mine --out styles"),
    "perform": (
        "kinesic perform welcome --robot upper36",
        "kinesic perform my.bml --style joyful --set power=0.5 --out report",
        "kinesic perform my.bml --on servos,twin --port body=/dev/ttyUSB0",
    ),
    "plan": ("kinesic plan welcome", "kinesic plan my.bml --out motion.csv", "kinesic plan my.txt --to bml"),
    "results": ("kinesic results summary reports", "kinesic results plot reports --out checks.png"),
    "robots check": ("kinesic robots check upper36",),
    "robots import": (
        "kinesic robots import robot.urdf --out robot.toml",
        "kinesic robots import robot.urdf --map left_wrist_yaw=l_wrist_pivot --force",
    ),
    "robots list": ("kinesic robots list",),
    "robots search": ("kinesic robots search upper22 documents --vary l_shoulder.length=0.20,0.25 --designs 8",),
    "robots show": ("kinesic robots show upper36",),
    "say": (
        'kinesic say "You took the big one?"',
        'kinesic say "Hello." --style calm --to bml',
        "kinesic say --audio speech.wav --words speech.json",
    ),
    "serve": ("kinesic serve --robot upper36", "kinesic serve --listen 127.0.0.1:9000 --text"),
    "servos accept": (
        "kinesic servos accept out/welcome --port body=/dev/ttyUSB0",
        "kinesic servos accept acceptance.json --port body=/dev/ttyUSB0",
    ),
    "servos calibrate": ("kinesic servos calibrate --port body=/dev/ttyUSB0",),
    "servos doctor": ("kinesic servos doctor --port body=/dev/ttyUSB0",),
    "servos reboot": ("kinesic servos reboot --port /dev/ttyUSB0 --id 5 --baud 1000000",),
    "servos record": ("kinesic servos record --port body=/dev/ttyUSB0 --out nod.csv",),
    "servos release": ("kinesic servos release --port body=/dev/ttyUSB0",),
    "servos scan": ("kinesic servos scan", "kinesic servos scan --port /dev/ttyUSB0 --baud 1000000"),
    "servos set-baud": ("kinesic servos set-baud --port /dev/ttyUSB0 --id 5 --to 1000000",),
    "servos set-id": ("kinesic servos set-id --port /dev/ttyUSB0 --id 1 --to 5",),
    "servos show": ("kinesic servos show --port body=/dev/ttyUSB0",),
    "servos simulate": ("kinesic servos simulate --folder ports", "kinesic servos simulate --physics twin"),
    "servos stop": ("kinesic servos stop",),
    "studio": ("kinesic studio my.bml",),
    "styles list": ("kinesic styles list",),
    "styles show": ("kinesic styles show joyful", "kinesic styles show mine.toml --set power=0.5 --json"),
    "study analyse": ("kinesic study analyse answers.csv",),
    "study make": ("kinesic study make --out my-study",),
    "study make-speech": ("kinesic study make-speech --text one.txt --text two.txt --compare whole_body=0",),
    "study make-gestures": ("kinesic study make-gestures --compare effort=0 --count 24",),
    "sweep": ("kinesic sweep beat --parameter power", "kinesic sweep offer --all --out sweep"),
    "twin fit": ("kinesic twin fit out/demo/measured.npz --out mine.toml",),
    "validate": ("kinesic validate welcome story", "kinesic validate documents --out reports --jobs 2"),
}


def attach_examples(group: click.Group, *words: str) -> None:
    """Append command-line examples to the help pages of a group's verbs."""
    for name, command in group.commands.items():
        path = (*words, name)
        if isinstance(command, click.Group):
            attach_examples(command, *path)
        elif " ".join(path) in VERB_EXAMPLES:
            lines = "\n".join(f"  {example}" for example in VERB_EXAMPLES[" ".join(path)])
            command.epilog = f"{command.epilog or ''}\n\n\b\nExamples:\n{lines}".strip()

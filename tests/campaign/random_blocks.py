"""Random setups and BML blocks of the campaign."""

from dataclasses import replace
from random import Random

from kinesic.expressivity.style.style import EXPRESSIVITY_RANGES, Expressivity, Style
from kinesic.planning.setup import Setup
from kinesic.session.setup import set_up

ROBOTS = ("upper22",) * 39 + ("upper36",) * 10 + ("human",)  # robots by frequency; larger ones take longer to plan
STYLES = ("neutral", "calm", "joyful", "sad", "angry", "proud", "shy")
AUDIENCES = ("nobody", "nobody", "adult", "child")  # people near the robot, by frequency
AMOUNTS = (0.0, 0.0, 1.0, 2.0)  # amounts of idle motion and variation
BEHAVIOUR_COUNTS = (1, 1, 1, 1, 2, 3)  # numbers of behaviours in a block by frequency
MODES = ("LEFT_HAND", "RIGHT_HAND", "BOTH_HANDS")
SIDES = ("left", "right")
LEANS = ("LEANING_FORWARD", "LEANING_BACKWARD")
EMOTIONS = ("SMILE", "FROWN", "BLINK", "RAISE_BROWS")
WORDS = ("yes", "this", "robot", "moves", "quite", "far", "over", "there", "and", "back")
MAX_STROKE_TIME = 1.5  # [s] latest requested stroke of a block's first behaviour
ROOT = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{}</bml>'


def random_setup(chance: Random) -> Setup:
    """Return a setup with random robot, style, idle motion and audience.

    Standing posture and variation are random, too.
    """
    return set_up(
        chance.choice(ROBOTS),
        style=chance.choice(STYLES),
        idle=chance.choice(AMOUNTS),
        variation=chance.choice(AMOUNTS),
        seed=chance.randrange(10_000),
        pause=chance.choice((0.0, 1.0)),
        near=chance.choice(AUDIENCES),
    )


def vary_expressivity(setup: Setup, chance: Random) -> Setup:
    """Return the setup with random expressivity.

    In half of the cases the setup stays the same.
    """
    if chance.random() < 0.5:
        return setup
    values = {
        name: chance.choice((low, high, chance.uniform(low, high))) for name, (low, high) in EXPRESSIVITY_RANGES.items()
    }
    return replace(setup, style=Style.uniform(Expressivity(**values), "random"))


def random_block(chance: Random, lexemes: list[str]) -> str:
    """Return a block of one to three random behaviours."""
    count = chance.choice(BEHAVIOUR_COUNTS)
    return ROOT.format("".join(_behaviour(chance, lexemes, place) for place in range(count)))


def _behaviour(chance: Random, lexemes: list[str], place: int) -> str:
    name, time = f"b{place}", chance.uniform(0.0, MAX_STROKE_TIME * (place + 1))
    lexeme, mode, side = chance.choice(lexemes), chance.choice(MODES), chance.choice(SIDES)
    stroke = f' stroke="{time:.3f}"' if chance.random() < 0.6 else ""
    words = " ".join(chance.choice(WORDS) for _ in range(chance.randint(1, 4)))
    gesture = f'<gesture id="{name}" lexeme="{lexeme}" mode="{mode}"{stroke}/>'
    others = (
        f'<head id="{name}" lexeme="{chance.choice(("NOD", "SHAKE"))}" amount="{chance.random():.2f}" '
        f'repetition="{chance.randint(1, 3)}" start="{time:.3f}"/>',
        f'<gaze id="{name}" target="{side}" start="{time:.3f}" end="{time + chance.uniform(0.3, 3.0):.3f}"/>',
        f'<gazeShift id="{name}" target="{side}" start="{time:.3f}"/>',
        f'<headDirectionShift id="{name}" target="{side}" start="{time:.3f}"/>',
        f'<pointing id="{name}" target="{side}"{stroke}/>',
        f'<posture id="{name}" start="{time:.3f}" end="{time + 2.0:.3f}"><pose part="WHOLEBODY" '
        f'lexeme="{chance.choice(LEANS)}"/></posture>',
        f'<faceLexeme id="{name}" lexeme="{chance.choice(EMOTIONS)}" amount="{chance.random():.2f}" '
        f'start="{time:.3f}" end="{time + 1.0:.3f}"/>',
        f'<speech id="{name}"><text>{words} <sync id="m"/>{chance.choice(WORDS)}.</text></speech>'
        f'<gesture id="{name}g" lexeme="{lexeme}" stroke="{name}:m"/>',
    )
    return gesture if chance.random() < 0.6 else chance.choice(others)

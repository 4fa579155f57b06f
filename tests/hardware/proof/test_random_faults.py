"""Random faults with raised arms, on both virtual servos: a handful; `make soak` has two hundred of each."""

from pathlib import Path

import pytest

from .drill import drill, random_strike

FOLDED = 3.5  # [s] until what holds after a fault has lost its patience, and folded
SEEDS = (11, 13)  # one of a servo and one of a wire, on kinesic's servos and on those of the manual


@pytest.mark.parametrize("seed", SEEDS)
def test_no_rule_is_broken(servos: str, tmp_path: Path, seed: int):
    strike, made = random_strike(servos, seed), drill(servos, tmp_path)
    made.raise_arms()
    made.suffer(strike, after=FOLDED)
    made.end()
    assert made.observer.broken == [], strike.name
    assert not (strike.wire and made.called_stuck), made.kinds()

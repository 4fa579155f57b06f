"""Random faults with raised arms on both kinds of virtual servos; `make soak` runs two hundred of each."""

from pathlib import Path

import pytest

from .drill import drill, random_strike

FOLDED = 3.5  # [s] until what holds after a fault has lost its patience, and folded
SEEDS = {"kinesic": 11, "manual": 13}  # a fault of a servo and one of a wire


@pytest.mark.parametrize(
    ("servos", "seed"),
    [
        pytest.param(servos, seed, marks=[pytest.mark.soak] * (SEEDS[servos] != seed))
        for servos in SEEDS
        for seed in SEEDS.values()
    ],
    indirect=["servos"],
)
def test_random_faults_break_no_safety_rule(servos: str, tmp_path: Path, seed: int):
    strike, made = random_strike(servos, seed), drill(servos, tmp_path)
    made.raise_arms()
    made.suffer(strike, after=FOLDED)
    made.end()
    assert made.observer.broken == [], strike.name
    assert not (strike.wire and made.called_stuck), made.kinds()

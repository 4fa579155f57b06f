"""Hostile documents: mutated ones neither crash nor stall the server, and none names a file of its machine."""

import random
import re
import wave
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from kinesic.bench.blocks import corpus_folder
from kinesic.body.command import RATE
from kinesic.body.config import CONFIGS
from kinesic.report.batch import documents

from .mutations import MUTATIONS, mutate

pytestmark = pytest.mark.realtime

OWN = sorted((CONFIGS / "bml").glob("*.bml"))
COUNT = 120
RECORDING = (
    '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="{}"><speech id="s" start="0"><text>Hello.</text>'
    '<description priority="1" type="audio/x-wav"><file ref="{}"/></description></speech></bml>'
)


@pytest.mark.parametrize("mutation", MUTATIONS)
@pytest.mark.parametrize("document", [b"", b"<", b'<bml id="a" b="c"/>', OWN[0].read_bytes()])
def test_every_mutation_takes_any_document(mutation, document):
    made = {mutation(document, random.Random(seed)) for seed in range(20)}
    assert all(isinstance(each, bytes) for each in made)


def test_the_same_seed_makes_the_same_document():
    document = OWN[0].read_bytes()
    made = [mutate(document, seed) for seed in range(50)]
    assert made == [mutate(document, seed) for seed in range(50)]
    assert len(set(made)) > 40


def test_a_sample_of_them_is_answered_while_the_robot_performs(abused, monkeypatch):
    where = corpus_folder()
    files = OWN if where is None else documents((where,))
    chance = random.Random(7)
    crowd = [mutate(chance.choice(files).read_bytes()[:6000], seed) for seed in range(COUNT)]
    session = abused.open.clients.session
    patient = replace(abused.open.clients.rules, planning=120.0)  # this machine may be busy with other tests
    monkeypatch.setattr(session.planner, "_rules", patient)
    deaths, before = session.planner.deaths, len(abused.witness.commands)
    with abused.client() as wild:
        answered = 0
        for number, document in enumerate(crowd):
            wild.send_bytes(document.replace(b"\0", b" "))
            wild.do("ping", id=str(number))
            while f'"id":"{number}"' not in (wild.receive(30) or "nothing"):
                answered += 1
            while session.status()["waiting"]:
                wild.receive(0.01)
        wild.do("interrupt")
        with abused.client() as client:
            messages = list(client.perform('<bml id="sane"><head id="h" lexeme="NOD" start="0"/></bml>'))
    assert re.search(r'id="sane:end"', messages[-1])
    assert session.planner.deaths == deaths
    ticks = np.rint([RATE * command.time for _, command in abused.witness.commands[before:]]).astype(int)
    assert (np.diff(ticks) == 1).all()


def test_a_recording_that_a_client_names_is_not_played(server, tmp_path: Path):
    path = tmp_path / "secret.wav"
    with wave.open(str(path), "wb") as file:
        file.setparams((1, 2, 8000, 0, "NONE", ""))
        file.writeframes(bytes(2 * 8000 * 5))
    with server.client() as client:
        answers = list(client.perform(RECORDING.format("plays", path)))
    (warning,) = (answer for answer in answers if "warningFeedback" in answer)
    assert "is not played: a document that is no file has no folder to find it in" in warning

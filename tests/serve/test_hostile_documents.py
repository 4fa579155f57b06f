"""Hostile documents neither crash nor stall the server nor read its files."""

import random
import re
import wave
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from kinesic.bench.blocks import find_corpus
from kinesic.body.command import COMMAND_RATE
from kinesic.body.config import CONFIGS
from kinesic.report.batch import documents

from .mutations import ALL_MUTATIONS, mutate

pytestmark = pytest.mark.realtime

EXAMPLE_FILES = sorted((CONFIGS / "bml").glob("*.bml"))
DOCUMENT_COUNT = 120  # number of hostile documents in `make soak`
QUICK_COUNT = 8  # number of these documents that are tested in every run
RECORDING_BML = (
    '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="{}"><speech id="s" start="0"><text>Hello.</text>'
    '<description priority="1" type="audio/x-wav"><file ref="{}"/></description></speech></bml>'
)


@pytest.mark.parametrize("mutation", ALL_MUTATIONS)
@pytest.mark.parametrize("document", [b"", b"<", b'<bml id="a" b="c"/>', EXAMPLE_FILES[0].read_bytes()])
def test_each_mutation_of_a_hostile_document_returns_bytes(mutation, document):
    made = {mutation(document, random.Random(seed)) for seed in range(20)}
    assert all(isinstance(item, bytes) for item in made)


def test_mutations_of_hostile_documents_are_deterministic():
    document = EXAMPLE_FILES[0].read_bytes()
    made = [mutate(document, seed) for seed in range(50)]
    assert made == [mutate(document, seed) for seed in range(50)]
    assert len(set(made)) > 40


@pytest.mark.parametrize(
    "sample",
    [
        pytest.param(slice(0, QUICK_COUNT), id="few"),
        pytest.param(slice(QUICK_COUNT, DOCUMENT_COUNT), id="others", marks=pytest.mark.soak),
    ],
)
def test_sampled_hostile_documents_neither_kill_the_planner_nor_delay_the_block_of_another_client(
    abused, monkeypatch, sample
):
    where = find_corpus()
    files = EXAMPLE_FILES if where is None else documents((where,))
    chance = random.Random(7)
    crowd = [mutate(chance.choice(files).read_bytes()[:6000], seed) for seed in range(DOCUMENT_COUNT)][sample]
    session = abused.open.clients.session
    patient = replace(abused.open.clients.rules, planning=120.0)  # the machine may be busy with other tests
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
    ticks = np.rint([COMMAND_RATE * command.time for _, command in abused.witness.commands[before:]]).astype(int)
    assert (np.diff(ticks) == 1).all()


def test_recordings_named_by_clients_are_not_played(server, tmp_path: Path):
    path = tmp_path / "secret.wav"
    with wave.open(str(path), "wb") as file:
        file.setparams((1, 2, 8000, 0, "NONE", ""))
        file.writeframes(bytes(2 * 8000 * 5))
    with server.client() as client:
        answers = list(client.perform(RECORDING_BML.format("plays", path)))
    (warning,) = (answer for answer in answers if "warningFeedback" in answer)
    assert "is not played: the document is not a file, so it has no folder" in warning

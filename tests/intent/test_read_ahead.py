"""Tests of language tables, loaded once for all forked processes."""

from importlib import reload

from kinesic.intent import read_ahead
from kinesic.intent.behaviour_sets import builtin_sets
from kinesic.intent.meaning.cue_table import load_cues, load_senses
from kinesic.intent.reading.language import load_language
from kinesic.serve.planner import TEXT_TABLES_MODULE


def test_importing_read_ahead_loads_the_english_cues_senses_rules_and_behaviour_sets():
    reload(read_ahead)  # other tests may have emptied the caches
    assert read_ahead.__name__ == TEXT_TABLES_MODULE
    assert read_ahead.CUES_READ is load_cues("en")
    assert read_ahead.CUES_READ.cues
    assert read_ahead.SENSES_READ is load_senses("en")
    assert read_ahead.RULES_READ is load_language("en")
    assert read_ahead.BEHAVIOUR_SETS_READ is builtin_sets()

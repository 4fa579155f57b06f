"""Cues, senses, rules and behaviour sets for English, loaded before processes fork."""

from kinesic.intent.behaviour_sets import builtin_sets
from kinesic.intent.meaning.cue_table import load_cues, load_senses
from kinesic.intent.reading.language import ENGLISH_TAG, load_language

CUES_READ = load_cues(ENGLISH_TAG)
SENSES_READ = load_senses(ENGLISH_TAG)
RULES_READ = load_language(ENGLISH_TAG)
BEHAVIOUR_SETS_READ = builtin_sets()

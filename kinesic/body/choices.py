"""Literal types of options with fixed names, such as `VoiceName`."""

from typing import Literal

KeyFrameFilling = Literal["complex", "lazy"]  # key frames with all body parts, or only with sufficiently important ones
VoiceName = Literal["auto", "hibari", "espeak", "durations"]  # speech engine; `durations` is silent
GrammarName = Literal["rules", "spacy"]  # parser of phrases and clauses in plain text
GesturePreference = Literal["lexicon", "captured"]  # gestures of beats, offers and deictics of a text
InvertedTerms = Literal["full", "lag", "none"]  # inverted terms of the servo model: all; velocity lag only; none
Variant = Literal["female", "male"]  # face model
Skin = Literal["female"]  # skin mesh of a virtual human's whole body
Audience = Literal["nobody", "adult", "child"]  # people near the robot, for limits of contacts
MappingTrust = Literal["checked", "any"]  # accepted joint mappings of imported robots

"""What users choose by name: the closed sets that the command line, Python and documents share."""

from typing import Literal

Gathering = Literal["complex", "lazy"]  # how key frames are filled: in every part, or only where a part counts enough
VoiceName = Literal["auto", "espeak", "durations"]  # who speaks; durations is silent and the same on every machine
GrammarName = Literal["rules", "spacy"]  # who finds phrases and clauses of a plain text
Terms = Literal["full", "lag", "none"]  # inverted of a servo: everything; what speed needs, but no torque; nothing
Variant = Literal["female", "male"]  # the face
Skin = Literal["female"]  # of a whole figure

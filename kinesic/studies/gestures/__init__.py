"""The gestures of the lexicon: each played alone, drawn as key postures, and listed as a vocabulary."""

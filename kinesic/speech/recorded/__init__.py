"""Timing of recorded speech: lips, words and accents that follow the sound."""

"""Conversion of plain text to intents by words, phrases and language rules."""

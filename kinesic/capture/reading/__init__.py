"""Parsers of motion files, from bytes to captured motion."""

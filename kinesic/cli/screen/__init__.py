"""Coloured text, tables and live lines for the terminal."""

"""Judges a performance and reports it: checks, figures, JSON, a page, and many documents at once."""

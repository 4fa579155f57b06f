"""Reads a document, whatever its notation, into a block of behaviours and sync references."""

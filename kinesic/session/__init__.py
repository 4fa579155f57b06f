"""Composition root: planning setups and plans from names, files and options."""

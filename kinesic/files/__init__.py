"""Writes what people keep: never through a link, and never over what is not kinesic's."""

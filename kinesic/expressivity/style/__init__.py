"""Styles and expressivity parameters of each behaviour, per modality."""

"""Conversion of plain text and FML to intents, behaviours and BML."""

"""Reader of everyday text: spoken words, stage directions, pauses and warnings."""

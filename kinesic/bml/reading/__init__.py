"""Reading of BML documents in all notations into behaviours and sync references."""

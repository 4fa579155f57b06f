"""Solution of the time constraints between sync points."""

"""Read the files of foreign robots within bounds."""

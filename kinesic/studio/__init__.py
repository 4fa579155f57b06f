"""The page on which documents are written, seen and performed in a browser."""

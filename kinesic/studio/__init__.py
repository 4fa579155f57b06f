"""Browser page to write, preview and perform BML documents."""

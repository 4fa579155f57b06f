"""Browser page to write, preview and perform documents."""

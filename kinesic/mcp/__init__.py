"""MCP tools for language models: gesture search, documents, text, gaze and stop."""

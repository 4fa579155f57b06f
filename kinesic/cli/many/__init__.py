"""What verbs share that do many things: who works through them, and tables of what came of it."""

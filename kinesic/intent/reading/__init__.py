"""From plain text to intents: words and phrases, and what the rules of a language find in them."""

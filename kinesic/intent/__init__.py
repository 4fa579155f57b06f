"""From meaning to behaviour: plain text and FML become intents, intents become behaviours, behaviours become BML."""

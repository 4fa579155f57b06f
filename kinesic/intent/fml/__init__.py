"""FML-APML documents: their intentions, and BML that shows them."""

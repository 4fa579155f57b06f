"""How bytes of clients come and go: messages in them, transports, who may connect, and how much is read."""

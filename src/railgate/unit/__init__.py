"""The on-board unit: its three functions together, and whole runs of a train through them."""

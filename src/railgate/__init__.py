"""On-board train functions as open, proven gateware."""

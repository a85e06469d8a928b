"""Places and routes every function for real parts: what speed it reaches, what it takes (SYS-3)."""

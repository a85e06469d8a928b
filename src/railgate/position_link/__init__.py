"""The position link: asks a maglev position system for its word and hands it to the radio unit."""

"""The vital output: two FPGAs with unrelated clocks that drive one relay together, 2-out-of-2."""

"""The vital output's gateware: one channel, half of each output. By its data flow:

timekeeper (own time), command (frames, with check), receiver of crosslink (peer, with oscillator),
forwarded (the peer's frames, a check too) → vote (τ0, what is stored) → storage (image and its life)
→ output with its feedback, one each, and shutoff (their test) → pulses, transmitter of crosslink;
status counts; channel joins them.
"""

from railgate.vital_output.gateware.channel import Channel

__all__ = ["Channel"]

"""The vital output's gateware: one channel, half of each output. By its data flow:

timekeeper (own time), command (the own CPU's frames, with a check), receiver of crosslink (the
peer, with its oscillator), forwarded (a check of the peer's frames) → vote (τ0, what is stored) →
storage (the image and its life) → an output with its feedback each, and shutoff (their test) →
pulses, transmitter of crosslink; status counts; channel joins them.
"""

from railgate.vital_output.gateware.channel import Channel

__all__ = ["Channel"]

"""The vital output's model: the gateware's twin, from event to event.

One channel by itself, or both with all that is around them. Kernels, from the bottom up: clocks,
pins; frames, messages; link, vote, drive with trains: a channel's parts; channel: one tick of it;
wires, repeats, resting, relays: the loop; run: over clock edges, with its log. They work on records
and limits; engine makes waveforms of it all.
"""

from railgate.vital_output.model.alone import ChannelModel
from railgate.vital_output.model.pair import PairModel

__all__ = ["ChannelModel", "PairModel"]

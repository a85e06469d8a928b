"""What each function is driven with, to be compared with what its model makes of it."""

from railgate.fpga.export.stimuli.channel import channel
from railgate.fpga.export.stimuli.link import link
from railgate.fpga.export.stimuli.wheel import wheel

__all__ = ["channel", "link", "wheel"]

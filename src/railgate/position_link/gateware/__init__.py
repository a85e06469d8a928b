"""The position link's gateware: two lines ask, two answer, one word a cycle. By its data flow:

inputs, timing (bit clock, request, schedule) → reader (answer, causes on the line) → verdict
(causes of the word, good or faulty) → supervision (state of the link, fields) → radio (frame);
link joins them.
"""

from railgate.position_link.gateware.link import PositionLink

__all__ = ["PositionLink"]

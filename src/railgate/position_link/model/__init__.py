"""The position link's model: the gateware's twin, from event to event; and a reader of captures.

pins → line (what each cycle says, compiled) → words (what speaks against one) → link (what is
delivered, compiled) → outputs, radio; model puts them together. reading takes a captured line
through the same line and words.
"""

from railgate.position_link.model.model import Model
from railgate.position_link.model.reading import Answer, Reading, read_line

__all__ = ["Answer", "Model", "Reading", "read_line"]

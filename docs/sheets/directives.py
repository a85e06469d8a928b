"""The parts as directives of Sphinx."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective
from sphinx.util.typing import ExtensionMetadata

from sheets.accuracy import estimators, periods, phases
from sheets.commands import helps
from sheets.configuration import configuration, derived
from sheets.evidence import bounded, claimed, required
from sheets.exports import maps
from sheets.faults import found, found_on_line
from sheets.layers import contracts, layers
from sheets.ports import ports
from sheets.registers import blocks, map_of
from sheets.resources import resources
from sheets.scenarios import scenarios
from sheets.timing import timing

__all__ = ["PARTS", "setup"]

Maker = Callable[[str], str]
"""Makes Markdown of a directive's argument."""

PARTS: Mapping[str, Maker] = {
    "ports": ports,
    "registers": blocks,
    "map": map_of,
    "configuration": configuration,
    "derived": derived,
    "claims": claimed,
    "bounded": bounded,
    "requirements": required,
    "scenarios": scenarios,
    "help": helps,
    "phases": phases,
    "periods": periods,
    "estimators": estimators,
    "faults": found,
    "line-faults": found_on_line,
    "resources": resources,
    "layers": layers,
    "contracts": contracts,
    "timing": timing,
}


class Part(SphinxDirective):
    """Stands for what its maker makes, as if it were written in the page."""

    optional_arguments = 1
    final_argument_whitespace = True
    make: Maker

    def run(self) -> list[nodes.Node]:
        """The nodes of the Markdown. A ValueError of the maker ends the build."""
        argument = self.arguments[0] if self.arguments else ""
        return self.parse_text_to_nodes(type(self).make(argument), offset=self.content_offset)


def setup(app: Sphinx) -> ExtensionMetadata:
    """Register the parts, and the exports of the register maps beside the pages."""
    for name, maker in PARTS.items():
        app.add_directive(name, type(name.title(), (Part,), {"make": staticmethod(maker)}))
    app.connect("build-finished", maps)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}

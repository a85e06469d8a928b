"""Parts of the pages that are made from the code when the site is built, each a directive.

A part is Markdown, or HTML in a Markdown fence, that a function makes from the code as it is, so
that no table of ports, registers, limits or figures is written a second time (SYS-1).
"""

from sheets.directives import setup

__all__ = ["setup"]

"""What a docstring tells of names, in the house's form: `one, other: what they are.`"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator

__all__ = ["told"]


def told(docstring: str, names: Collection[str]) -> Iterator[tuple[str, str]]:
    """Each of these names of which something is told, and the text up to the next of them."""
    text = " ".join(docstring.split())
    name = rf"`?\b(?:{'|'.join(map(re.escape, names))})\b`?"
    found = list(re.finditer(rf"(?<![\w.])({name}(?:(?:,| and) {name})*): ", text))
    for match, after in zip(found, [*found[1:], None], strict=True):
        rest = text[match.end() : after.start() if after else len(text)].strip()
        for each in re.split(r",? ", match[1].replace("`", "").replace(" and ", ", ")):
            yield each, rest

"""Gateware broken on purpose: monitors built from a patched source."""

from __future__ import annotations

import sys
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, nullcontext
from importlib.abc import MetaPathFinder
from importlib.machinery import ModuleSpec, PathFinder, SourceFileLoader
from importlib.util import find_spec
from pathlib import Path
from types import CodeType, ModuleType

from amaranth.hdl import Fragment

from railgate.proving.claim import GATEWARE, Claim, Mutant
from railgate.proving.monitor import Monitor

__all__ = ["elaborated", "mutated", "patched"]

_importing = threading.RLock()
"""The modules of the gateware are the process's; one claim's mutant holds them at a time."""


def elaborated(claim: Claim, mutant: Mutant | None = None) -> Monitor:
    """The claim's monitor, made once for all of the gateware, or of a mutant of it.

    It can be converted or simulated once. Raises ValueError where the patch does not fit.
    """
    with _importing, mutated(mutant) if mutant else nullcontext():
        monitor = claim.monitor()
        if not isinstance(monitor, Monitor):
            raise ValueError(f"{claim.name} must make a Monitor, not a {type(monitor).__name__}")
        fragment = Fragment.get(monitor, None)
    fragment.origins = fragment.origins[1:]  # it comes in again when the fragment is used
    monitor.elaborate = lambda _platform: fragment
    return monitor


def patched(mutant: Mutant) -> str:
    """The source of the mutant's module with the patch. Raises ValueError."""
    spec = find_spec(mutant.module)
    if spec is None or not spec.origin:
        raise ValueError(f"{mutant.name}: no module {mutant.module}")
    source = Path(spec.origin).read_text(encoding="utf-8")
    if (times := source.count(mutant.old)) != 1:
        raise ValueError(
            f'{mutant.name}: "{mutant.old}" must be in {mutant.module} just once, not {times} times'
        )
    return source.replace(mutant.old, mutant.new)


@contextmanager
def mutated(mutant: Mutant) -> Iterator[None]:
    """While it lasts, gateware that is imported is fresh, and broken by the mutant's patch."""
    with _importing:
        finder = _Finder(mutant.module, patched(mutant))
        before = _taken_out()
        sys.meta_path.insert(0, finder)
        try:
            yield
        finally:
            sys.meta_path.remove(finder)
            _taken_out()
            sys.modules.update(before)
            for name, module in before.items():
                parent, _, child = name.rpartition(".")
                setattr(sys.modules[parent], child, module)


def _taken_out() -> dict[str, ModuleType]:
    """All modules of gateware, which are then as if they had never been imported."""
    found = {name: module for name, module in sys.modules.items() if GATEWARE.match(name)}
    for name in found:
        del sys.modules[name]
        parent, _, child = name.rpartition(".")
        if parent in sys.modules:
            vars(sys.modules[parent]).pop(child, None)
    return found


class _Finder(MetaPathFinder):
    """Finds one module, with another text."""

    def __init__(self, module: str, text: str) -> None:
        self._module, self._text = module, text

    def find_spec(
        self, name: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        if name != self._module:
            return None
        spec = PathFinder.find_spec(name, path, target)
        if spec is not None and spec.origin:
            spec.loader = _Loader(name, spec.origin, self._text)
        return spec


class _Loader(SourceFileLoader):
    """Compiles the text that it is given, past all caches."""

    def __init__(self, name: str, path: str, text: str) -> None:
        super().__init__(name, path)
        self._text = text

    def get_code(self, fullname: str) -> CodeType:
        return self.source_to_code(self._text.encode(), self.get_filename(fullname))

"""Gateware broken on purpose, and whole again afterwards."""

import importlib
import sys

import pytest

import railgate.odometer
import railgate.primitives
from railgate.odometer.proofs import inputs
from railgate.primitives import FilteredInput
from railgate.proving import Mutant
from railgate.proving.mutation import elaborated, mutated, patched
from railgate.proving.netlist import netlist

INPUTS = "railgate.primitives.inputs"
GATEWARE = "railgate.odometer.gateware"
STAGE_MORE = Mutant("stage-more", INPUTS, "STAGES = 2", "STAGES = 3")


def test_gateware_imported_meanwhile_is_broken_and_before_and_after_it_is_whole() -> None:
    with mutated(STAGE_MORE):
        from railgate.odometer.gateware import sensor
        from railgate.primitives import inputs as broken

        assert broken.STAGES == 3
        assert broken.FilteredInput is sensor.FilteredInput is not FilteredInput
    assert importlib.import_module(INPUTS).STAGES == 2
    assert railgate.primitives.inputs.FilteredInput is FilteredInput
    from railgate.odometer.gateware import sensor as whole

    assert whole.FilteredInput is FilteredInput


def test_gateware_that_was_not_imported_before_is_not_afterwards() -> None:
    with mutated(STAGE_MORE):
        assert GATEWARE not in sys.modules
        with mutated(STAGE_MORE):
            importlib.import_module(GATEWARE)
        assert GATEWARE not in sys.modules
        assert not hasattr(railgate.odometer, "gateware")


def test_it_is_whole_again_after_an_error_too() -> None:
    with pytest.raises(SyntaxError), mutated(Mutant("no-python", INPUTS, "STAGES = 2", "STAGES =")):
        importlib.import_module(INPUTS)
    assert importlib.import_module(INPUTS).STAGES == 2


@pytest.mark.parametrize(("old", "times"), [("STAGES = 7", 0), ("STAGES", 3)])
def test_a_patch_fits_just_once(old: str, times: int) -> None:
    with pytest.raises(ValueError, match=rf"must be in {INPUTS} just once, not {times} times"):
        patched(Mutant("odd", INPUTS, old, "x"))


@pytest.mark.parametrize("module", ["railgate.cli", "amaranth.hdl", "railgate.odometer.spec"])
def test_only_gateware_may_be_broken(module: str) -> None:
    with pytest.raises(ValueError, match=rf"or railgate\.<function>\.gateware.*not {module}"):
        Mutant("odd", module, "a", "b")


def test_a_missing_module_is_told() -> None:
    with pytest.raises(ValueError, match=r"no module railgate\.primitives\.none"):
        patched(Mutant("odd", "railgate.primitives.none", "a", "b"))


def test_a_monitor_is_made_of_the_broken_gateware() -> None:
    claim = inputs.CLAIMS[0]
    whole = netlist(elaborated(claim), helped=False)
    assert netlist(elaborated(claim, STAGE_MORE), helped=False) != whole
    assert netlist(elaborated(claim), helped=False) == whole

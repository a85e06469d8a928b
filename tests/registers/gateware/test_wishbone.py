"""The bridge from Wishbone, by an outside judge: cocotbext-wishbone in Verilator."""

from registers.gateware.judged import judge


def test_cocotbexts_master_finds_nothing_wrong(tmp_path):
    judge("registers.gateware.judges.wishbone", tmp_path)

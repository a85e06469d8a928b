"""The bridge from AXI4-Lite, by an outside judge: cocotbext-axi in Verilator."""

from registers.gateware.judged import judge


def test_cocotbexts_master_finds_nothing_wrong(tmp_path):
    judge("registers.gateware.judges.axi", tmp_path)

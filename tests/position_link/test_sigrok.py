"""The words on the line, by an outside judge: sigrok's SPI decoder, mode 1, UEF as chip select."""

import re
import shutil
import subprocess

import pytest

from railgate.position_link.decode import decode
from railgate.position_link.host import example
from railgate.position_link.plant import Scenario, fault
from railgate.position_link.simulate import simulate
from railgate.position_link.spec import Config
from railgate.waves import Trace, write_vcd

GOLDEN = [
    0x04A30025F743970E,
    0x14A20025F74CDD2B,
    0x24A20025F7562275,
    0x34A20025F75F682C,
    0x45A20025F768AD4C,
    0x64A20025F77B37A2,
]
"""What sigrok-cli 0.7.2 reads of the line below: the fifth word with the wrong bit in it."""


@pytest.fixture(scope="module")
def line() -> Trace:
    faults = (fault("bit-error:8@80ms"), fault("missing@100ms"))
    config = example().applied_to(Config())
    run = simulate(Scenario(faults=faults), config, 7, layout=example(), wave_cycles=7)
    return run.waves.select(["clk", "uef", "data"])


@pytest.mark.shows("LNK-3")
def test_decode_reads_the_words_that_sigrok_reads(line) -> None:
    layout = example()
    found = decode(line, layout.config, layout)
    assert [answer.word for answer in found.answers if answer.word is not None] == GOLDEN
    assert [not answer.causes for answer in found.answers] == [1, 1, 1, 1, 0, 0, 1]


@pytest.mark.skipif(not shutil.which("sigrok-cli"), reason="sigrok-cli is not installed")
def test_golden_words_are_those_of_sigrok(line, tmp_path) -> None:
    path = tmp_path / "line.vcd"
    write_vcd(path, line)
    spi = "spi:clk=clk:mosi=data:cs=uef:cs_polarity=active-high:cpol=0:cpha=1:wordsize=64"
    command = ["sigrok-cli", "-I", "vcd", "-i", path, "-P", spi, "-A", "spi=mosi-data"]
    told = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    assert [int(word, 16) for word in re.findall(r": ([0-9A-F]+)", told)] == GOLDEN

#!/bin/sh
# A real capture, then a simulated train run to 200 km/h, both through the odometer's model; then the
# position link with three faults, and its line read again as a sniffer would; then two channels of
# the vital output and their relay, one of whose CPUs dies.
set -e
railgate=.venv/bin/railgate
capture=tests/data/sigrok/avago_adns_2051_move_mouse_fast.sr
echo "A real two-channel encoder, captured at 1 MHz: $capture"
$railgate measure $capture --a XA --b XB --acceleration-max 20 --out build/demo/capture
echo
echo "A simulated train: to 200 km/h and back to rest, 200 pulses a revolution, 650 mm wheel"
$railgate simulate odometer --profile run --speed 200 --seconds 160 --every 100ms --out build/demo/run
echo
echo "A position link: one answer missing, UEF stuck for 90 ms, one bit of DATA wrong"
$railgate simulate link --fault missing@100ms --fault stuck@200ms..290ms --fault bit-error:5@400ms \
    --out build/demo/link
echo
echo "The same line, as a sniffer reads it"
$railgate decode build/demo/link/link.vcd --clk clk --uef uef --data data --anf anf \
    --layout src/railgate/position_link/host/example.toml
echo
echo "A vital output: CPU 1 falls silent while a relay is held"
$railgate simulate vital --situation cpu-dead --out build/demo/vital

#!/bin/sh
# A real capture, then a simulated train run to 200 km/h, both through the odometer's model.
set -e
railgate=.venv/bin/railgate
capture=tests/data/sigrok/avago_adns_2051_move_mouse_fast.sr
echo "A real two-channel encoder, captured at 1 MHz: $capture"
$railgate measure $capture --a XA --b XB --acceleration-max 20 --out build/demo/capture
echo
echo "A simulated train: to 200 km/h and back to rest, 200 pulses a revolution, 650 mm wheel"
$railgate simulate odometer --profile run --speed 200 --seconds 160 --every 100ms --out build/demo/run

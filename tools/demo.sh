#!/bin/sh
# A real capture through the odometer's model, then the whole on-board unit: a metro between four
# platforms, whose doors are released at standstill.
set -e
railgate=.venv/bin/railgate
capture=tests/data/sigrok/avago_adns_2051_move_mouse_fast.sr
echo "A real two-channel encoder, captured at 1 MHz: $capture"
$railgate measure $capture --a XA --b XB --acceleration-max 20 --out build/demo/capture
echo
echo "The whole unit: a metro between four platforms, doors released at standstill"
$railgate run metro --out build/demo/metro

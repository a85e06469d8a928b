"""The odometer: wheel-sensor edges to period, phase and distance."""

"""The train's route: it stops at its platforms, and nowhere else."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from railgate.unit.route import Route, Stop

places = st.lists(st.integers(1, 4_000), min_size=2, max_size=6, unique=True).map(
    lambda found: [float(place) for place in sorted(found)]
)


@given(places, st.floats(10, 430), st.floats(0.1, 2), st.floats(0.1, 2))
def test_the_train_rests_at_every_platform_from_its_arrival_to_its_departure(
    at: list[float], speed_kmh: float, up: float, down: float
) -> None:
    stops = [Stop(at_m=place, dwell_s=10) for place in at]
    route = Route(stops=stops, speed_kmh=speed_kmh, acceleration_m_s2=up, braking_m_s2=down)
    profile = route.profile()
    for call in route.calls:
        times = np.array([call.arrives_s, call.departs_s])
        assert profile.position_m(times) + route.start_m == pytest.approx(call.stop.at_m, abs=1e-3)
        assert profile.speed_kmh(times) == pytest.approx(0, abs=1e-6)
        assert call.departs_s - call.arrives_s == pytest.approx(10)
    assert profile.speeds_m_s.max() <= speed_kmh / 3.6 + 1e-9
    assert profile.speeds_m_s.min() >= 0
    assert profile.acceleration_m_s2 <= max(up, down) * (1 + 1e-9)


@pytest.mark.parametrize(
    ("stops", "told"),
    [
        ([Stop(at_m=0)], "stops must be at least 2, not 1"),
        ([Stop(at_m=5), Stop(at_m=5)], "stops must be in order of place, not 5 m after 5 m"),
    ],
)
def test_a_route_that_leads_nowhere_is_refused(stops: list[Stop], told: str) -> None:
    with pytest.raises(ValueError, match=told):
        Route(stops=stops)

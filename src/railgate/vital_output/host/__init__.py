"""The CPU's side of a channel: its command frames, and what the channel tells of itself."""

from railgate.vital_output.host.frames import encode
from railgate.vital_output.host.status import Status, status_bytes

__all__ = ["Status", "encode", "status_bytes"]

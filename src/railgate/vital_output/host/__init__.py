"""The CPU's side of a channel: its command frames, and what the channel tells of itself."""

from railgate.vital_output.host.frames import encode, encoded
from railgate.vital_output.host.status import Status, status_bytes

__all__ = ["Status", "encode", "encoded", "status_bytes"]

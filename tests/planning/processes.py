"""Which processes are left."""

import os
from pathlib import Path


def running(mark):
    """Processes that inherited the mark and have not ended, this one apart."""
    found = []
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            if folder.name != str(os.getpid()) and mark.encode() in (folder / "environ").read_bytes():
                found.append(folder.name)
        except OSError:
            continue
    return found

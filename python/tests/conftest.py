"""What all tests share."""

import os

# Workers of Ray give way to all other programs, and take tens of seconds to start beside the other tests.
os.environ.setdefault("RAY_worker_niceness", "0")

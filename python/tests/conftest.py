"""What all tests share."""

import os

# Workers of Ray give way to all other programs, and would take minutes to start beside the other tests.
os.environ.setdefault("RAY_worker_niceness", "0")

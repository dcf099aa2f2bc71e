"""What all tests share."""

import os
import signal

# Workers of Ray give way to all other programs, and take tens of seconds to start beside the other tests.
os.environ.setdefault("RAY_worker_niceness", "0")

# A shell without job control lets its background programs ignore Ctrl-C, and Python then raises nothing.
signal.signal(signal.SIGINT, signal.default_int_handler)

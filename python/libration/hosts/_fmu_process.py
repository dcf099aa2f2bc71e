"""The process of an FMU, as its parent sees it."""

from __future__ import annotations

import json
import queue
import re
import signal
import subprocess
import sys
import tempfile
import threading
import weakref
from pathlib import Path
from typing import IO, Any

_DISCARD = 2
# Times in s that the process has at least to load the FMU, and to free it.
_LOAD, _FREE = 60.0, 2.0
# The child has the search path of its parent; a program that is run by its path would search in its own folder first.
_PROGRAM = "import sys; sys.path[:] = sys.argv[2:]; import runpy; runpy.run_path(sys.argv[1], run_name='__main__')"


class FmuProcess:
    """A child process with an FMU. It begins with the first request, and anew after a crash, an error or a time-out."""

    def __init__(self, name: str, load: dict[str, Any], timeout: float) -> None:
        self.name, self.load, self.timeout = name, load, timeout
        self.end: weakref.finalize[..., Any] | None = None

    def request(self, operation: str, *arguments: Any) -> Any:
        """Return the result of an operation, or None if the FMU discards the step.

        Raises
        ------
        RuntimeError
            If the FMU reports an error, or ends its process.
        TimeoutError
            If it does not answer in time.
        """
        if self.end is None:
            self._start()
            self._answer({"operation": "load", **self.load}, "load")
        return self._answer({"operation": operation, "arguments": arguments}, operation)

    def close(self) -> None:
        """End the process."""
        if self.end is not None:
            self.end()
            self.end = None

    def _start(self) -> None:
        self.log: IO[bytes] = tempfile.TemporaryFile()
        program = str(Path(__file__).with_name("_fmu_child.py"))
        self.process = subprocess.Popen(
            [sys.executable, "-u", "-c", _PROGRAM, program, *sys.path],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self.log,
            encoding="utf-8",
        )
        self.answers: queue.Queue[str | None] = queue.Queue()
        reader = threading.Thread(target=_read, args=(self.process.stdout, self.answers), daemon=True)
        reader.start()
        self.end = weakref.finalize(self, _end, self.process, reader, self.log)

    def _answer(self, request: dict[str, Any], operation: str) -> Any:
        assert self.process.stdin is not None
        limit = max(self.timeout, _LOAD) if operation == "load" else self.timeout
        try:
            self.process.stdin.write(json.dumps(request) + "\n")
            self.process.stdin.flush()
            line = self.answers.get(timeout=limit)
        except OSError:
            line = None
        except queue.Empty:
            self.process.kill()
            self.close()
            raise TimeoutError(
                f"{self.name} gave no answer in {limit:g} s ({operation}), and its process was ended; help: give a longer timeout"
            ) from None
        if line is None:
            raise RuntimeError(self._crash(operation))
        answer = json.loads(line)
        if "error" not in answer:
            return answer["result"]
        if operation == "step" and answer["status"] == _DISCARD:
            return None
        output = self._output()
        self.close()
        raise RuntimeError(f"{self.name}: {answer['error']}{output}")

    def _crash(self, operation: str) -> str:
        code = self.process.wait()
        self.log.seek(0)
        text = self.log.read().decode("utf-8", "replace")
        function = re.search(r" in (fmi[23]\w+)", text)
        where = function.group(1) if function else operation
        how = f"by {signal.Signals(-code).name}" if code < 0 else f"with exit code {code}"
        output = self._output()
        self.close()
        return f"{self.name} ended its process {how} in {where}{output}"

    def _output(self) -> str:
        """Return the last lines that the FMU printed, as a part of a message."""
        self.log.seek(0)
        text = self.log.read().decode("utf-8", "replace").split("Fatal Python error", 1)[0]
        lines = [line.strip() for line in text.splitlines() if line.strip()]
        return f"; its last output: {' / '.join(lines[-3:])[-300:]}" if lines else ""


def _read(stream: IO[str], answers: queue.Queue[str | None]) -> None:
    for line in stream:
        answers.put(line)
    answers.put(None)


def _end(process: subprocess.Popen[str], reader: threading.Thread, log: IO[bytes]) -> None:
    try:
        if process.stdin is not None:
            # The child frees the FMU at the end of its requests.
            process.stdin.close()
    except OSError:
        # A request that was not written.
        pass
    try:
        process.wait(_FREE)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
    reader.join(1.0)
    for stream in (process.stdout, log):
        if stream is not None:
            stream.close()

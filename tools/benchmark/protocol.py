"""How the benchmark talks to a peer in another process: a line of JSON each way."""

import json
import os
import subprocess
import sys
import traceback

from .places import BenchError, NotComparable


def serve(peer_class, arguments):
    """The peer's side: argument 1 holds the constructor's arguments; then one request a line."""
    # What libraries print must not get between the answers.
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    peer = None
    lines = [arguments[0]]
    while lines:
        request = json.loads(lines.pop())
        try:
            if peer is None:
                peer = peer_class(**request)
                answer = peer.about()
            else:
                answer = peer.render(**request)
        except NotComparable as error:
            answer = {"not_comparable": str(error)}
        except Exception as error:  # noqa: BLE001: whatever it is goes to the other side.
            traceback.print_exc()
            answer = {"error": f"{type(error).__name__}: {error}"}
        answers.write(json.dumps(answer) + "\n")
        answers.flush()
        line = sys.stdin.readline()
        lines = [line] if line else []


class Remote:
    """The benchmark's side of a peer."""

    def __init__(self, name, command, environment, log, **arguments):
        self.name, self.log = name, log
        with open(log, "a", encoding="utf-8") as errors:
            self.process = subprocess.Popen(
                [*map(str, command), json.dumps(arguments)],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=errors,
                text=True,
                env={**os.environ, **environment},
            )
        self.about = self.answer()

    def render(self, **request):
        self.process.stdin.write(json.dumps(request) + "\n")
        self.process.stdin.flush()
        return self.answer()

    def answer(self):
        line = self.process.stdout.readline()
        answer = json.loads(line) if line else {"error": f"it ended with exit code {self.process.wait()}"}
        if "not_comparable" in answer:
            raise NotComparable(answer["not_comparable"])
        if "error" in answer:
            raise BenchError(f"{self.name}: {answer['error']}; its output is in {self.log}", 3)
        return answer

    def close(self):
        self.process.stdin.close()
        self.process.wait()

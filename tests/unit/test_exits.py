"""How the program ends: at once, but with nothing lost that was promised."""

import subprocess
import sys

import pytest

AT_EXIT = "import atexit; atexit.register(lambda: print('closed'))"
THREAD = "import threading, time; threading.Thread(target=lambda: (time.sleep(0.2), print('worked'))).start()"
DAEMON = "import threading, time; threading.Thread(target=time.sleep, args=(60,), daemon=True).start()"


@pytest.mark.parametrize(
    ("before", "told"),
    [("", ""), (AT_EXIT, "closed\n"), (THREAD, "worked\n"), (DAEMON, ""), (f"{AT_EXIT}; {DAEMON}", "closed\n")],
)
def test_the_end_writes_out_all_text_runs_exit_functions_and_waits_for_threads(before: str, told: str) -> None:
    code = f"from femstruct.exits import end\n{before}\nprint('x' * 100_000)\nend(3)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=30, check=False)
    assert (done.returncode, done.stderr) == (3, "")
    assert done.stdout == "x" * 100_000 + "\n" + told

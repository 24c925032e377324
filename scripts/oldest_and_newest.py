"""The tests on the oldest packages that pyproject.toml allows, and on the newest: each in a fresh environment.

    python scripts/oldest_and_newest.py [oldest | newest] [pytest arguments ...]

Exits with the first failure's code. Tools that only developers use (pytest, type checkers) are the newest in both.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
import tomllib
import venv
from pathlib import Path

ROOT = Path(__file__).parents[1]
_TYPES = ("ruff", "mypy", "scipy-stubs")  # they check the newest only, and ask for new packages
_OF_ITS_TIME = ["click<8.5", "pyparsing<3.3"]  # what old typer and matplotlib call, the newest warn of
_PRODUCT = ("rslab", "xlsxwriter")  # of the tests' own packages: those that users install too


def requirements(age: str, pyproject: str) -> list[str]:
    """What pip shall install beside the project.

    >>> text = "project = {dependencies = ['numpy>=2.2'], optional-dependencies = {test = ['mypy>=2', 'pytest>=9']}}"
    >>> requirements("oldest", text)
    ['numpy==2.2', 'pytest>=9', 'click<8.5', 'pyparsing<3.3']
    """
    project = tomllib.loads(pyproject)["project"]
    own = project["dependencies"]
    tests = [line for line in project["optional-dependencies"]["test"] if not line.startswith(_TYPES)]
    if age == "newest":
        return [*own, *tests]
    users = [line for line in tests if line.startswith(_PRODUCT)]
    old = [line.replace(">=", "==") for line in [*own, *users]]
    return old + [line for line in tests if line not in users] + _OF_ITS_TIME


def run(age: str, arguments: list[str]) -> int:
    """Run the tests in a new environment; returns the exit code of pytest."""
    with tempfile.TemporaryDirectory() as folder:
        venv.create(folder, with_pip=True)
        python = Path(folder, "Scripts" if sys.platform == "win32" else "bin", "python")
        wanted = requirements(age, (ROOT / "pyproject.toml").read_text(encoding="utf-8"))
        install = [python, "-m", "pip", "install", "--quiet", "--upgrade"]
        subprocess.run([*install, "--editable", str(ROOT), *wanted], check=True)
        listed = subprocess.run([python, "-m", "pip", "freeze"], check=True, capture_output=True, text=True).stdout
        print(f"{age}:", *listed.split(), flush=True)
        # Old packages call what newer ones, that they need, will drop: not ours to mend.
        theirs = ("-W", "default::DeprecationWarning", "-W", "default::FutureWarning") if age == "oldest" else ()
        return subprocess.run([python, "-m", "pytest", "-q", *theirs, *arguments], cwd=ROOT).returncode


def main(arguments: list[str]) -> int:
    """Both sets, or the one named first."""
    ages = ("oldest", "newest")
    if arguments and arguments[0] in ages:
        ages, arguments = (arguments[0],), arguments[1:]
    return next((code for age in ages if (code := run(age, arguments))), 0)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

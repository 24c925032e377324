"""What the machine checks: random models, asked through the public door, against answers made by another way.

A capability is a name with a function that draws one case; `@capability(...)` makes it known, one file a subject. The
same seed, name and index draw the same case on every machine and in every order.
"""

from __future__ import annotations

import importlib
import io
import json
import tempfile
import zlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final, Literal

import numpy as np
from ruamel.yaml import YAML

from tests.data.command_line import femstruct, histories

Model = Mapping[str, Any]
Floats = np.ndarray
Kind = Literal["independent", "relation", "limit"]
_NO_SUBJECTS: Final = ("__init__", "framework", "running")  # files of this package without capabilities
_DISTRUST: Final = ("forbids trust", "limits trust")


class Refused(Exception):
    """The program refused the input (exit 2)."""


class Crashed(Exception):
    """The program ended with a fault of its own (exit 1, or anything else that is no answer)."""


@dataclass
class Door:
    """The command line in this process. told : findings, among all that was asked, that take trust from an answer."""

    told: list[str] = field(default_factory=list)

    def ask(
        self,
        model: Model,
        command: str,
        *words: str,
        first: Sequence[Sequence[str]] = (),
        **beside: Model | str | bytes,
    ) -> dict[str, Any]:
        """JSON answer of `femstruct COMMAND model.yaml WORDS --json`.

        beside : further models by their name, and other files as text or bytes by name and ending; first : commands
        before it, such as those that write what the model takes.
        """
        with tempfile.TemporaryDirectory() as place:
            for name, content in {"model": model, **beside}.items():
                if isinstance(content, bytes):
                    (Path(place) / name).write_bytes(content)
                    continue
                other = isinstance(content, str)
                text = content if isinstance(content, str) else as_yaml(content)
                (Path(place) / (name if other else f"{name}.yaml")).write_text(text, encoding="utf-8")
            for one in (*first, (command, "model.yaml", *words, "--json")):
                ended = femstruct(*one, cwd=Path(place))
                if ended.returncode == 2:
                    raise Refused(ended.stderr.strip())
                if ended.returncode not in (0, 3):
                    raise Crashed(f"exit {ended.returncode}: {ended.stderr.strip()[-2000:]}")
        if ended.returncode == 3 and not ended.stdout:  # not converged, and says so
            raise Refused(ended.stderr.strip())
        answer: dict[str, Any] = json.loads(ended.stdout)
        severe = [one for one in answer.get("findings", ()) if one.get("severe") or one.get("rank") in _DISTRUST]
        self.told += [f"{one['code']}: {one['message']}" for one in severe]
        if ended.returncode == 3 and not severe:
            self.told.append(f"exit 3: {ended.stderr.strip()[-500:]}")
        return answer

    def histories(self, model: Model, **beside: Model | str) -> dict[str, Floats]:
        """Histories of a study by channel, their times "t", its shock spectra as "NAME positive"; beside: `ask`."""
        with tempfile.TemporaryDirectory() as place:
            for name, content in {"model": model, **beside}.items():
                if isinstance(content, str):
                    (Path(place) / name).write_text(content, encoding="utf-8")
                else:
                    (Path(place) / f"{name}.yaml").write_text(as_yaml(content), encoding="utf-8")
            try:
                found = histories(Path(place) / "model.yaml")
            except Exception as told:  # what it refuses comes back as words
                raise Crashed(f"{type(told).__name__}: {told}") from told
        if isinstance(found, str):
            raise Refused(found)
        return found

    def modes(self, model: Model, count: int) -> Floats:
        """Natural frequencies [Hz]."""
        return np.array(self.ask(model, "modes", "--count", str(count))["frequency_hz"])

    def statics(self, model: Model, *forces: str, weight: bool = False) -> dict[str, Any]:
        """Answer at rest; forces such as 'tip.z=-10 N'."""
        words = [word for force in forces for word in ("--force", force)]
        return self.ask(model, "statics", *words, *(["--weight"] if weight else []))


Answer = Callable[[Model, Door], Floats]


@dataclass(frozen=True)
class Case:
    """One model, what is asked of it and the right answer.

    asked, right : of a model, so that a shrunk one is judged like the first; an independent answer leaves the door
    alone, a relation asks it for another model. tolerance : relative to the largest of the right answer, or with `each`
    to each number of it; reason : why that much. knobs : dotted paths of the model; numbers below them may be
    simplified and entries dropped.
    """

    model: Model
    asked: Answer
    right: Answer
    tolerance: float
    reason: str
    knobs: tuple[str, ...] = ()
    each: bool = False


@dataclass(frozen=True)
class Capability:
    """draw : a case from random numbers. refuses : the program may refuse what is drawn. slow : left out of the default
    tests, which have 20 s for one check of each."""

    name: str
    kind: Kind
    draw: Callable[[np.random.Generator], Case]
    refuses: bool = False
    slow: bool = False

    def case(self, seed: int, index: int) -> Case:
        """The case of a seed and an index, whatever was drawn before."""
        return self.draw(np.random.default_rng([seed, zlib.crc32(self.name.encode()), index]))


_known: dict[str, Capability] = {}


def capability(
    name: str, kind: Kind, refuses: bool = False, slow: bool = False
) -> Callable[[Callable[[np.random.Generator], Case]], Callable[[np.random.Generator], Case]]:
    """Make a function that draws cases known under a name."""

    def keep(draw: Callable[[np.random.Generator], Case]) -> Callable[[np.random.Generator], Case]:
        if name in _known and _known[name].draw.__module__ != draw.__module__:
            raise ValueError(f"capability {name!r}: two files have it, expected one name for one thing")
        _known[name] = Capability(name, kind, draw, refuses, slow)
        return draw

    return keep


def capabilities() -> dict[str, Capability]:
    """All that are known, by name: a file of this package that is no test has some."""
    for path in sorted(Path(__file__).parent.glob("*.py")):
        if path.stem not in _NO_SUBJECTS and not path.stem.startswith("test_"):
            importlib.import_module(f"tests.machine.{path.stem}")
    return dict(sorted(_known.items()))


def as_yaml(model: Model) -> str:
    """The text of a model's file."""
    text, yaml = io.StringIO(), YAML(typ="safe", pure=True)
    yaml.width = 10**9  # a key with a blank, such as "50.4 Hz", that is broken over lines, is no YAML
    yaml.dump(_plain(model), text)
    return text.getvalue()


def _plain(value: Any) -> Any:
    """Numbers of numpy as numbers of Python."""
    if isinstance(value, Mapping):
        return {str(key): _plain(one) for key, one in value.items()}
    if isinstance(value, list | tuple | np.ndarray):
        return [_plain(one) for one in value]
    return value.item() if isinstance(value, np.generic) else value

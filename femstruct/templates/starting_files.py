"""Files to start from: a model and a study of each kind, written to a folder under a name of one's own."""

from __future__ import annotations

import re
from collections.abc import Sequence
from difflib import get_close_matches
from importlib.resources import files
from pathlib import Path
from typing import Final

from femstruct.errors import InputError

KINDS: Final = ("joist-floor", "clt-floor", "slab", "floating-floor", "press", "hammer", "room")
GIVES: Final = {  # what comes of each as it is written: bands end where the modes do
    "joist-floor": "levels up to 50 Hz, half a minute",
    "clt-floor": "levels up to 125 Hz",
    "slab": "rated by ISO 717-2",
    "floating-floor": "levels up to 315 Hz of two cases",
    "press": "motions and forces of two cases, with limits",
    "hammer": "motions and forces of two cases, with limits",
    "room": "levels up to 100 Hz, transfer from force to sound",
}
_MODEL, _STUDY = ".yaml", ".study.yaml"


def what_of(kind: str) -> str:
    """What a kind is, the title of its study, and what it gives.

    >>> what_of("slab")
    'The rubber ball on a concrete slab over a room: rated by ISO 717-2'
    """
    return f"{_text(kind, _STUDY).partition(chr(10))[0].removeprefix('title: ')}: {GIVES[kind]}"


def named(kind: str, name: str = "") -> dict[str, str]:
    """The files of a kind by name, with the name of one's own in them.

    Raises InputError for a kind that there is not, naming the nearest, and for a name that is not one.

    >>> list(named("slab", "my_slab"))
    ['my_slab.yaml', 'my_slab.study.yaml']
    """
    if kind not in KINDS:
        near = get_close_matches(kind, KINDS, n=1)
        do = f"did you mean '{near[0]}'?" if near else ""
        raise InputError("new", got=f"'{kind}'", expected=f"one of {', '.join(KINDS)}", do=do)
    own = name or _stem(kind)
    if not re.fullmatch(r"[\w-][\w .-]*", own) or own.endswith(_MODEL):
        do = f"write femstruct new {kind} my_{_stem(kind)}"
        raise InputError("new", got=f"'{name}'", expected="a name without a folder and without .yaml", do=do)
    found = {}
    for suffix in (_MODEL, _STUDY):
        text = _text(kind, suffix)
        found[own + suffix] = text.replace(f"model: {_stem(kind)}{_MODEL}", f"model: {own}{_MODEL}")
    return found


def write_new(kind: str, name: str = "", folder: str | Path = ".") -> Sequence[Path]:
    """Write the files of a kind to a folder; returns where.

    Raises InputError, and writes nothing, where a file of that name is there already or the system refuses it.
    """
    texts = {Path(folder, own): text for own, text in named(kind, name).items()}
    for path in texts:
        if path.exists() or path.is_symlink():
            do = f"choose a name: femstruct new {kind} NAME"
            raise InputError("new", got=f"{path.name}, which is here already", expected="a new file", do=do)
    try:
        for path, text in texts.items():
            with path.open("x", encoding="utf-8", newline="\n") as file:  # x: never over another file
                file.write(text)
    except OSError as error:
        got = f"{path.name}: {error.strerror or error}"
        raise InputError("new", got=got, expected="a folder that can be written to") from None
    return tuple(texts)


def _stem(kind: str) -> str:
    return kind.replace("-", "_")


def _text(kind: str, suffix: str) -> str:
    return files(__package__).joinpath(_stem(kind) + suffix).read_text(encoding="utf-8")

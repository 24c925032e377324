"""YAML files as plain trees that remember the line and column of every key and value."""

from __future__ import annotations

import re
from functools import lru_cache
from itertools import accumulate
from pathlib import Path
from typing import Any, Final

from ruamel.yaml import YAML
from ruamel.yaml.error import MarkedYAMLError, YAMLError
from ruamel.yaml.nodes import MappingNode, Node, ScalarNode, SequenceNode

from femstruct.errors import InputError, InputErrors
from femstruct.files.inputs.opening import content
from femstruct.language.yaml.tree import Mistakes, Position, Steps, Tree, dotted, nearest

LARGEST_FILE: Final = 500_000  # bytes; a minute of reading at the worst, and far more than any model needs
LARGEST_TREE: Final = 100_000  # values, aliases followed
DEEPEST: Final = 40
_WHOLE: Final = re.compile(r"[-+]?[0-9]{1,18}")
_REAL: Final = re.compile(r"[-+]?(?:\.[0-9]+|[0-9]+(?:\.[0-9]*)?)(?:[eE][-+]?[0-9]+)?")
_NO_TEXT: Final = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\ud800-\udfff\ufffe\uffff]")
_NO_SPACE: Final = re.compile("[\u00a0\u2000-\u200a\u202f\u205f\u3000]")
_UNSEEN: Final = re.compile("[\u00ad\u200b\u200e\u200f\u202a-\u202e\u2060\u2066-\u2069\ufeff]")
_NOT_NUMBERS: Final = {".nan": "nan", ".inf": "inf", "+.inf": "inf", "-.inf": "-inf"}
_WORDS: Final = {
    **dict.fromkeys(("", "~", "null", "Null", "NULL")),
    **dict.fromkeys(("true", "True", "TRUE"), True),
    **dict.fromkeys(("false", "False", "FALSE"), False),
}


def read_yaml(path: str | Path, asked_at: Position | None = None, asked_path: str = "") -> Tree:
    """A YAML 1.2 file as a tree with positions.

    asked_at, asked_path : where another file names this one, for the message when it cannot be opened.

    Raises InputErrors, one line ``file:line:column: got, expected; do`` a mistake: a missing file (with the nearest
    name), a folder, binary data, an empty file, broken YAML, duplicate keys, tags, too many or circular aliases, a
    file that is too large.
    """
    mistakes, file = Mistakes(), str(path)
    text = _read_text(Path(path), asked_at or Position(file, 1, 1), asked_path)
    node, walk = _compose(text, file), _Walk(file, mistakes)
    value = walk.value(node, ())
    if not isinstance(value, dict):  # of whose file, nobody knows: it is not quoted
        got = "a list" if isinstance(value, list) else "text"
        mistakes.add(walk.values[()], "", got=got, expected="a mapping", do="begin with 'title: ...'")
    mistakes.stop_if_any()
    return Tree(file, value, walk.keys, walk.values, text)


def parse_value(text: str, file: str, mistakes: Mistakes) -> Tree:
    """The tree of a YAML text that may be any value, such as one from the command line, without lines."""
    walk, value = _Walk(file, mistakes), None
    try:
        value = walk.value(_compose(text, file), ())
    except InputErrors as errors:
        mistakes.note(errors.errors[0])
    positions = dict.fromkeys([*walk.keys, *walk.values, ()], Position(file))
    return Tree(file, value, positions, positions, text)


def lines_of_keys(text: str, file: str) -> dict[str, range]:
    """The lines, from 1, of every key of a YAML mapping and its value. Raises InputErrors for what is no YAML.

    >>> lines_of_keys("a: 1\\nb:\\n  c: 2\\n\\n# more\\nd: 3\\n", "x.yaml")
    {'a': range(1, 2), 'b': range(2, 4), 'd': range(6, 7)}
    """
    node, rows = _compose(text, file), text.splitlines()
    found: dict[str, range] = {}
    for key, value in node.value if isinstance(node, MappingNode) else ():
        end = value.end_mark.line + (value.end_mark.column > 0)
        while end > key.start_mark.line + 1 and rows[end - 1].strip().partition("#")[0] == "":
            end -= 1
        found[str(key.value)] = range(key.start_mark.line + 1, end + 1)
    return found


def _refused(at: Position, got: str, expected: str, do: str = "", path: str = "") -> InputErrors:
    mistakes = Mistakes()
    mistakes.add(at, path, got=got, expected=expected, do=do)
    return InputErrors(tuple(mistakes.lines))


def _read_text(path: Path, at: Position, asked_path: str) -> str:
    try:
        return content(path, LARGEST_FILE, "a YAML file").decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise _refused(at, _not_text(error), "text in UTF-8", "save it as UTF-8", asked_path) from None
    except InputError as error:
        do = "put large tables into CSV files" if error.got.startswith("a file of") else error.do
        do = nearest(path.name, _siblings(path)) if error.got.startswith("no file") else do
        raise _refused(at, error.got, error.expected, do, asked_path) from None


def _not_text(error: UnicodeDecodeError) -> str:
    before = error.object[: error.start]
    if b"\0" in error.object:
        return f"binary data (byte {error.start})"
    return f"a character in another encoding (line {before.count(10) + 1}, byte 0x{error.object[error.start]:02x})"


def _siblings(path: Path) -> list[str]:
    try:
        return [entry.name for entry in path.parent.iterdir() if entry.suffix in (".yaml", ".yml")]
    except (OSError, ValueError):
        return []


def _compose(text: str, file: str) -> Node:
    """The nodes of a text; raises InputErrors for what is no YAML."""
    at, told = Position(file, 1, 1), ("an empty file", "a mapping", "begin with 'title: ...'")
    try:
        if _bracket_depth(text) > 10 * DEEPEST:  # the YAML reader's time grows with its square
            raise RecursionError
        node = _composed(text)
        if node is not None:
            return node
    except MarkedYAMLError as error:
        quoted = error.context is not None and "quoted scalar" in error.context
        mark = (error.context_mark if quoted else None) or error.problem_mark or error.context_mark
        at = Position(file, mark.line + 1, mark.column + 1) if mark else at
        words = " ".join(str(part) for part in (error.context, error.problem) if part)
        tabs = "indent with spaces: YAML has no tabs" if "found character '\\t'" in words else ""
        told = (f"broken YAML ({words})", "YAML", tabs or _to_mend(error, quoted, text))
    except YAMLError:
        told = ("characters that are not text", "a text file", "")
    except RecursionError:
        told = ("endless nesting", f"at most {DEEPEST} levels", "")
    except (ValueError, AssertionError, AttributeError, TypeError, LookupError) as error:
        # the YAML reader trips over some broken texts with its own errors
        told = (f"broken YAML ({error})", "YAML", "")
    raise _refused(at, *told)


def _to_mend(error: MarkedYAMLError, quoted: bool, text: str) -> str:
    """What to do about broken YAML. quoted : whether a quote is not closed."""
    if quoted:
        return "close the quote that begins here"
    if error.context_mark is not None and "flow" in str(error.context):
        return f"check brackets, commas and quotes from line {error.context_mark.line + 1} on, where the bracket opens"
    if "mapping values are not allowed" in str(error.problem):
        above = list(enumerate(text.splitlines()[: error.problem_mark.line], start=1)) if error.problem_mark else []
        number, line = next(((n, row.strip()) for n, row in reversed(above) if row.strip()), (0, ""))
        if line and not (": " in line or line.endswith(":") or line.startswith(("#", "-"))):
            return f"line {number} is no 'key: value': write a colon and a space after its key"
        return "put quotes around text that contains ': ', and check indents"
    return "check brackets, quotes and indents"


@lru_cache(maxsize=16)
def _composed(text: str) -> Node | None:
    """The nodes of a text, which nobody changes; kept for files that are read again and again with other overrides."""
    node: Node | None = YAML(typ="safe", pure=True).compose(text)
    return node


def _bracket_depth(text: str) -> int:
    steps = (1 if match[0] in "[{" else -1 for match in re.finditer(r"[\[\]{}]", text))
    return max(accumulate(steps), default=0)


class _Walk:
    """From nodes to plain values, once through the tree."""

    def __init__(self, file: str, mistakes: Mistakes) -> None:
        self.file, self.mistakes = file, mistakes
        self.keys: dict[Steps, Position] = {}
        self.values: dict[Steps, Position] = {}
        self.overflowed = False

    def at(self, node: Node) -> Position:
        return Position(self.file, node.start_mark.line + 1, node.start_mark.column + 1)

    def value(self, node: Node, steps: Steps) -> Any:
        self.values[steps] = self.at(node)
        if self.overflowed:
            return None
        if len(self.values) > LARGEST_TREE or len(steps) > DEEPEST:
            self.overflowed = True
            self.mistakes.add(
                self.at(node),
                "",
                got="aliases (*name) or lists that expand endlessly",
                expected=f"at most {LARGEST_TREE} values, {DEEPEST} deep",
                do="write the values instead of the aliases",
            )
            return None
        if isinstance(node, MappingNode):
            return self.mapping(node, steps)
        if isinstance(node, SequenceNode):
            items = []
            for number, item in enumerate(node.value):
                self.keys[*steps, number] = self.at(item)
                items.append(self.value(item, (*steps, number)))
            return items
        return self.scalar(node, steps) if isinstance(node, ScalarNode) else None

    def mapping(self, node: MappingNode, steps: Steps) -> dict[str, Any]:
        found: dict[str, Any] = {}
        for key_node, value_node in node.value:
            at = self.at(key_node)
            if not isinstance(key_node, ScalarNode):
                self.mistakes.add(at, dotted(steps), got="a list or mapping as a key", expected="a name")
                continue
            key = str(key_node.value)
            if (blank := _NO_SPACE.search(key)) is not None:
                got = f"a blank that is no space (U+{ord(blank[0]):04X}) in a key"
                self.mistakes.add(at, dotted(steps), got=got, expected="a name", do="type a space, or nothing")
            if blank is not None or self.is_no_text(key, at, steps):
                continue
            if key in found:
                first = self.keys[*steps, key]
                self.mistakes.add(
                    at,
                    dotted((*steps, key)),
                    got=f"'{key}' twice (first in line {first.line})",
                    expected="each key once",
                    do="remove or rename one",
                )
                continue
            self.keys[*steps, key] = at
            found[key] = self.value(value_node, (*steps, key))
            if isinstance(value_node, ScalarNode) and not (value_node.value or value_node.style):
                self.values[*steps, key] = at  # nothing stands there: it would be the next line
        return found

    def is_no_text(self, text: str, at: Position, steps: Steps) -> bool:
        """Note what no system can print, write or use in a name: NUL and its like, halves of characters; and what
        nobody sees."""
        found = _NO_TEXT.search(text) or _UNSEEN.search(text)
        if found:
            kind = "cannot be seen" if _UNSEEN.fullmatch(found[0]) else "is no text"
            got = f"a character that {kind} (U+{ord(found[0]):04X})"
            self.mistakes.add(at, dotted(steps), got=got, expected="text", do="remove it")
        return found is not None

    def scalar(self, node: ScalarNode, steps: Steps) -> Any:
        text = str(node.value)
        tag = str(node.tag or "")
        if not tag.startswith("tag:yaml.org,2002:") or "python" in tag:
            self.mistakes.add(
                self.at(node), dotted(steps), got=f"the tag {tag}", expected="a plain value", do="remove the tag"
            )
            return None
        if self.is_no_text(text, self.at(node), steps):
            return None
        if node.style:  # quoted or block: always a text
            return text
        if text in _WORDS:
            return _WORDS[text]
        if _WHOLE.fullmatch(text):
            return int(text)
        if _REAL.fullmatch(text):
            return float(text)
        return float(_NOT_NUMBERS[text.lower()]) if text.lower() in _NOT_NUMBERS else text

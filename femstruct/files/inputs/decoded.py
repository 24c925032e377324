"""Text of files that analysers wrote: UTF-8, UTF-16 and what Windows has in Germany, Japan and Korea."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Final

from femstruct.errors import InputErrors, sentence

_EXPECTED: Final = "a table of text in UTF-8, UTF-16, cp1252, Shift-JIS or cp949"
_SAVE: Final = "save it as 'CSV UTF-8'"
_MARKS: Final = ((b"\xef\xbb\xbf", "utf-8-sig"), (b"\xff\xfe", "utf-16"), (b"\xfe\xff", "utf-16"))
_NULS: Final = 0.1  # of a file, at least
_HIGH: Final = re.compile(rb"[\x80-\xff]+")
_SIGNS: Final = r"\x00-\x7f\u00b0\u00b1\u00b2\u00b3\u00b5\u00b7\u00d7\u0394\u03bc\u2103\u2126\u3380-\u33dd"  # of units
_WESTERN: Final = re.compile(rf"[{_SIGNS}\u00a0\u00c0-\u00f6\u00f8-\u00ff\u2013\u2014\u2018-\u201e\u20ac]*")
_JAPANESE: Final = re.compile(rf"[{_SIGNS}\u3000-\u30ff\u4e00-\u9fff\uff01-\uff5e]*")
_KOREAN: Final = re.compile(rf"[{_SIGNS}\u3000-\u303f\uac00-\ud7a3\uff01-\uff5e]*")
_HANGUL: Final = re.compile("[\uac00-\ud7a3]")
_KANJI: Final = re.compile("[\u3040-\u30ff\u4e00-\u9fff]")
_KNOWN: Final = (  # in this order: plain Korean is no Shift-JIS, but the wider cp949 has most of its pairs
    ("euc_kr", _KOREAN, _HANGUL),
    ("cp932", _JAPANESE, _KANJI),
    ("cp949", _KOREAN, _HANGUL),
)


def decoded(path: Path, data: bytes) -> str:
    """The text of a file.

    Raises InputErrors, with the line, for what is no text and for text in an encoding that cannot be determined.

    Notes
    -----
    What has a byte order mark, or is right UTF-8, is that. Else an encoding is taken if all that is not ASCII is of its
    language: hangul of cp949; kana and kanji of Shift-JIS; single letters with accents between others, or signs of
    units, of cp1252. Numbers are ASCII in all of them.

    >>> decoded(Path("t.csv"), "Hz;Räume [s]".encode("cp1252")), decoded(Path("t.csv"), "주파수".encode("cp949"))
    ('Hz;Räume [s]', '주파수')
    >>> decoded(Path("t.csv"), "周波数、残響時間".encode("cp932")), decoded(Path("t.csv"), "63;1".encode("utf-16-le"))
    ('周波数、残響時間', '63;1')
    """
    for mark, name in _MARKS:
        if data.startswith(mark):
            return _strictly(path, data, name)
    first, second = data[::2].count(b"\0"), data[1::2].count(b"\0")  # every other byte of numbers in UTF-16
    if max(first, second) >= _NULS * len(data) > 10 * min(first, second):
        return _strictly(path, data, "utf-16-le" if second > first else "utf-16-be")
    try:
        text = data.decode("utf-8")
    except UnicodeDecodeError as error:
        return _legacy(path, data, error.start)
    return _text(path, text)


def _strictly(path: Path, data: bytes, encoding: str) -> str:
    try:
        return _text(path, data.decode(encoding))
    except UnicodeDecodeError as error:
        line = data[: error.start].decode(encoding, errors="replace").count("\n") + 1
        raise _wrong(path, line, f"a character that is not {encoding.upper()}") from None


def _legacy(path: Path, data: bytes, first: int) -> str:
    longest = max(map(len, _HIGH.findall(data)))  # bytes that are not ASCII side by side
    western = ("cp1252", _WESTERN, re.compile(""))
    for encoding, whole, telling in (western, *_KNOWN) if longest == 1 else (*_KNOWN, western):
        try:
            text = data.decode(encoding)
        except UnicodeDecodeError:
            continue
        if whole.fullmatch(text) and telling.search(text) and not (encoding == "cp1252" and longest > 2):
            return _text(path, text)
    line = data[:first].count(b"\n") + 1
    raise _wrong(path, line, f"a character in an unknown encoding (byte 0x{data[first]:02x})")


def _text(path: Path, text: str) -> str:
    if "\0" in text:
        raise _wrong(path, text[: text.index("\0")].count("\n") + 1, "a file that is no text")
    return text


def _wrong(path: Path, line: int, got: str) -> InputErrors:
    return InputErrors((f"{path}:{line}:1: {sentence('', got, _EXPECTED, _SAVE)}",))

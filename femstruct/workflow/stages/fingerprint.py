"""Whether two descriptions are the same to the last number: a short name for all that is in them."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np
from scipy.sparse import csr_array


def fingerprint(value: Any) -> str:
    """A name that changes with any number, word or array in a frozen description: dataclasses, mappings, sequences.

    Raises TypeError for what has no value of its own, such as a function: it would be told from itself.

    >>> fingerprint([1.0, {"a": np.arange(3)}]) == fingerprint([1.0, {"a": np.arange(3)}])
    True
    >>> fingerprint(csr_array([[1.0, 0.0]])) == fingerprint(csr_array([[0.0, 1.0]]))
    False
    >>> fingerprint(np.zeros(5000)) == fingerprint(np.append(np.zeros(4999), 1e-9))
    False
    """
    digest = hashlib.sha256()
    _add(digest, value)
    return digest.hexdigest()[:12]


def _add(digest: Any, value: Any) -> None:
    digest.update(f"({type(value).__qualname__}".encode())
    if is_dataclass(value) and not isinstance(value, type):
        for one in fields(value):
            digest.update(f" {one.name}:".encode())
            _add(digest, getattr(value, one.name))
    elif isinstance(value, np.ndarray):
        digest.update(f" {value.dtype} {value.shape}".encode() + np.ascontiguousarray(value).tobytes())
    elif isinstance(value, csr_array):
        for array in (np.array(value.shape), value.indptr, value.indices, value.data):
            _add(digest, array)
    elif isinstance(value, Mapping):
        for key, one in value.items():
            digest.update(f" {key!r}:".encode())
            _add(digest, one)
    elif isinstance(value, list | tuple):
        for one in value:
            _add(digest, one)
    elif isinstance(value, set | frozenset):
        for text in sorted(map(repr, value)):
            digest.update(text.encode())
    elif value is None or isinstance(value, bool | int | float | complex | str | bytes | np.generic):
        digest.update(f" {value!r}".encode())
    else:
        raise TypeError(f"{type(value).__qualname__} has no fingerprint")
    digest.update(b")")

"""Names of places that are not there are answered with the nearest."""

from __future__ import annotations

from typing import cast

import pytest

from femstruct.errors import InputError
from femstruct.model.probe import Point
from femstruct.workflow.bases import Places


@pytest.mark.parametrize("asked", ["drumcentre", "centre"])
def test_a_place_is_named_though_it_is_not_among_the_first(asked: str) -> None:
    points = {name: cast("Point", None) for name in (*(f"a{number}" for number in range(20)), "drum centre")}
    with pytest.raises(InputError, match=r"--response: .* and \d+ more; did you mean 'drum centre'\?$"):
        Places(points, {}).point(asked, "--response")

"""Contacts as they are written: a law between two ends."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Annotated

from femstruct.language.laws.known_laws import AnyLaw
from femstruct.language.study.body import BodySpec, ends_of, law_of
from femstruct.language.study.body_arrays import joined
from femstruct.language.yaml import Ends, Gap, Here, Quantity, Spec
from femstruct.study.acting import PlannedContact


class BetweenSpec(Spec):
    """What acts between two ends: points, bodies or the ground."""

    between: Ends

    def check_ends(self, here: Here, sizes: Mapping[str, int], ends: Collection[str]) -> None:
        """Note what its ends are not. sizes : of arrays of bodies. ends : names of bodies and the ground."""
        counts, there = joined(self.between, sizes, here.names), here.at("between")
        there.need(
            len({count for count in counts if count > 1}) <= 1,
            " and ".join(f"{count} {end}" for count, end in zip(counts, self.between, strict=False)),
            "as many of both, or one",
            "name one of them, as NAME.1",
        )
        for number, end in enumerate(self.between):
            if not counts or counts[number] == 1:
                there.at(number).place(end, ends)
        there.need(self.between[0] != self.between[1], f"'{self.between[0]}' twice", "two different ends")


class ContactSpec(BetweenSpec):
    """A unilateral law between two ends.

    gap: opening at t = 0. preload: force that the contact has at rest; what presses it there, such as a spring or a
    screw, is in balance with it and is left out: a link needs no preload for it.
    """

    law: AnyLaw
    gap: Gap = 0.0
    preload: Annotated[float, Quantity(("force",), least=0.0)] = 0.0

    def check_in(self, here: Here, struck: Collection[str]) -> None:
        """Note keys that do not agree; struck : bodies that are lifted off at every blow."""
        here.need(
            not (self.gap and self.preload),
            f"a gap of {self.gap:g} m and a preload of {self.preload:g} N",
            "one of them",
            "a preloaded contact is closed: remove the gap",
        )
        held = [end for end in self.between if end in struck] if self.preload else []
        here.at("preload").need(
            not held,
            f"a preload on '{''.join(held[:1])}', which is lifted off at every blow",
            "none",
            "remove it, or the blows",
        )

    def build(
        self, here: Here, name: str, bodies: Mapping[str, BodySpec], sources: dict[str, str]
    ) -> PlannedContact | None:
        """The contact it describes; None with a mistake noted. sources : see `law_of`."""
        law = law_of(self.law, ends_of(bodies, *self.between), here.at("law"), sources)
        if law is None:
            return None
        if self.preload:
            law.indentation(self.preload)  # a table may end below it
        return PlannedContact(name, self.between, law, self.gap, self.preload)


def check_contacts(here: Here, contacts: Mapping[str, ContactSpec], bodies: Mapping[str, BodySpec]) -> None:
    """A body that owns its contact agrees with the named one between the same ends; so do two named ones."""
    by_ends: dict[frozenset[str], str] = {}
    for name, contact in contacts.items():
        first = by_ends.setdefault(frozenset(contact.between), name)
        here.at("contacts", name).need(
            first == name or contacts[first].gap != contact.gap,
            f"a second contact between {' and '.join(contact.between)} (the first is '{first}')",
            "one contact, or another gap",
            "remove one",
            of_key=True,
        )
    for name, body in bodies.items():
        own, named = f"{name} on {body.target}", by_ends.get(frozenset((name, body.target)))
        if body.contact is None:
            continue
        here.at("bodies", name).at("contact").need(
            named is None or contacts[named].law == body.contact,
            f"a contact that disagrees with 'contacts.{named}' between the same ends",
            "one contact, or two that agree",
            "remove one of them",
            of_key=True,
        )
        here.at("contacts", own).need(
            named is not None or own not in contacts,
            "the name of a body's own contact",
            "another name",
            "rename it",
            of_key=True,
        )

"""Impacts on a modal basis: what meets, the laws, the march through time, and where the energy goes.

Modules, each importing only from those to its left: ``collisions restitution factored laws bodies response compiled
rule system tables forces flow propagate events energy sampling march collocate judgement simulate estimate``.
"""

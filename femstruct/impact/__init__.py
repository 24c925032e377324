"""Impacts on a modal basis: what meets, the laws, the march through time, and where the energy goes.

Modules, each importing only from those to its left: ``collisions restitution factored laws bodies compiled rule system
tables forces motion response flow propagate events energy sampling strikes march collocate outcome judgement blows
simulate estimate unresolved vary many fleet metrics batch``.
"""

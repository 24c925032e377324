"""Impacts on a modal basis: what meets, the laws, the march through time, and where the energy goes.

Modules, each importing only from those to its left: ``collisions restitution compiled records laws bodies rule system
tables forces motion response flow propagate events energy sampling closings strikes booking march collocate outcome
judgement blows simulate estimate unresolved vary many fleet metrics batch``.
"""

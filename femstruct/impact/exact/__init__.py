"""The exact march: systems whose laws are all linear, propagated to rounding between events.

A regime (which contacts are closed, which one-way dashpots act) is one linear system; its flow over a step is a power
series, so that gaps, speeds and forces are polynomials whose roots are bracketed. The march by collocation is beside
it in `femstruct.impact`, for laws that are not linear and for structures whose fast modes make these steps too short.
"""

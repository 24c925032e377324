"""`crest_factors`."""

from femstruct.language.evaluations import EvaluationSpec
from femstruct_guest.crest import CrestRequest


class CrestSpec(EvaluationSpec):
    """The peak of a recorded velocity over its root mean square, of: POINT.z."""

    makes = CrestRequest
    signs = ("crest_factors",)

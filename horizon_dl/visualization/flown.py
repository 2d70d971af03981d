"""What titles say of the bearings that are flown: one wording for panels, films and pages."""

from horizon_dl.runtime.ranged import Ranged

RANGES_TITLE = "what is flown: free green, blocked red, unknown grey"
WITHOUT_EVIDENCE = "the flown rule, no evidence asked for"


def ranges_title(ranges: Ranged) -> str:
    """Title of the picture with bearings; it says where they are not quite what would be flown."""
    title = RANGES_TITLE if ranges.asked else WITHOUT_EVIDENCE
    return title if ranges.has_metres or ranges.doubts else f"{title}; no metres"


def unknown_words(ranges: Ranged) -> str:
    """Why bearings are unknown; '' where none is for want of evidence."""
    return f"unknown: {', '.join(ranges.doubts)}" if ranges.doubts else ""

"""Notes of readers that say more than how something was read: that it may be wrong."""


class Doubt(str):
    """A note of what nothing in the files decides; it is shown as a warning, other notes as facts.

    Example:
        >>> notes = ("camera of /camera_info", Doubt("tf gives base_link two parents"))
        >>> [note for note in notes if isinstance(note, Doubt)]
        ['tf gives base_link two parents']
    """

    __slots__ = ()

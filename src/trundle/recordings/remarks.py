"""`Remarks`: what was left out of a recording, or taken to be so, each kind once with how often."""

from __future__ import annotations


class Remarks:
    """Remarks about a recording in the order of their first occurrence."""

    def __init__(self) -> None:
        self._counts: dict[str, int] = {}
        self._notes: list[str] = []

    def note(self, text: str) -> None:
        """Add a remark that is said once, however often it is noted."""
        if text not in self._notes:
            self._notes.append(text)

    def count(self, text: str, times: int = 1) -> None:
        """Count something; the text follows the number: "scans … are left out"."""
        if times:
            self._counts[text] = self._counts.get(text, 0) + times

    @property
    def lines(self) -> tuple[str, ...]:
        """All remarks, one line each."""
        return (*self._notes, *(f"{times} {text}" for text, times in self._counts.items()))

"""What hangs together, by union-find: almost linear in the number of joints, and quick for furniture of a few parts."""

from __future__ import annotations

from collections.abc import Iterable


class Groups:
    """The numbers 0, 1, …, count - 1, of which more and more are joined."""

    def __init__(self, count: int, joints: Iterable[tuple[int, int]] = ()) -> None:
        self._parent = list(range(count))
        for a, b in joints:
            self.join(a, b)

    def join(self, a: int, b: int) -> None:
        """Makes one group of those of `a` and `b`; its least member stands for it."""
        a, b = self.of(a), self.of(b)
        self._parent[max(a, b)] = min(a, b)

    def of(self, member: int) -> int:
        """The member that stands for the group: its least."""
        parent = self._parent
        while parent[member] != member:
            parent[member] = member = parent[parent[member]]
        return member

    def all(self) -> list[list[int]]:
        """The groups, each sorted, by their least member."""
        found: dict[int, list[int]] = {}
        for member in range(len(self._parent)):
            found.setdefault(self.of(member), []).append(member)
        return list(found.values())

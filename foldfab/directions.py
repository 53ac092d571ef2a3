"""Which direction furniture folds along best: each candidate is solved, and the best has the highest score.

score = space saving - cost - `HINGE` for each hinge inserted - share lost

The space saving is what folding flat is for: a fold of one small flap costs nothing, but saves little. The cost is how
much is changed by the paper's measure (eq. 1), and each hinge has to be printed and turned. Lost is the share of all
parts' area that is taken away, or that lies level in print though it stands in the furniture.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from foldfab.errors import AbstractionError, FoldfabError, FoldingError
from foldfab.fitting import along
from foldfab.geometry.arrays import Array
from foldfab.recipe.model import Recipe
from foldfab.scaffold.directions import Line, is_across, lines, main_frame, title
from foldfab.scaffold.turned import turned

if TYPE_CHECKING:
    from foldfab.folding.model import FoldSolution

HINGE = 0.01
"""What a hinge inserted takes off the score: as much as 1 % of space."""
MOST_LOST = 0.5
"""Share of the furniture; where more of it is lost, it is not this furniture that folds."""
SEARCH = 0.5
"""Seconds of work for each direction, where the recipe allows more; the best one is solved anew with all of them."""
_WORTH_SAYING = 0.005
"""Shares below this round to nothing."""
_DIGITS = 2
"""Of scores: of those that agree in them the way down is best, as furniture stands, then that along x."""


@dataclass(frozen=True, slots=True, eq=False)
class Way:
    """One direction: what becomes of the furniture along it, or why nothing does."""

    direction: Array
    """(3,) unit."""
    problem: str = ""
    """Why it does not fold; empty where it does."""
    solution: FoldSolution | None = None
    opened: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Size of the smaller of its boxes along the recipe's axes and along its own, open, mm of print."""
    folded: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Size of its smallest box that stands along the direction, folded, mm of print; the last one is along it."""
    level: Mapping[str, float] = field(default_factory=dict)
    """By part that is laid level, its share of the area of all parts, as far as it is turned."""
    removed: float = 0.0
    """The share that is taken away."""

    @property
    def name(self) -> str:
        """The direction as it is written in a recipe."""
        return title(self.direction)

    @property
    def cost(self) -> float:
        """Eq. 1."""
        return self.solution.cost if self.solution else 0.0

    @property
    def saving(self) -> float:
        """1 - folded over open bounding volume."""
        return 1.0 - float(np.prod(self.folded) / np.prod(self.opened)) if self.solution else 0.0

    @property
    def hinges(self) -> int:
        """How many are inserted."""
        return sum(m.hinges for m in self.solution.modifications) if self.solution else 0

    @property
    def gone(self) -> tuple[str, ...]:
        """The patches that are taken away."""
        return tuple(m.patch for m in self.solution.modifications if m.is_deleted) if self.solution else ()

    @property
    def lost(self) -> float:
        """The share of the parts' area that is taken away or laid level."""
        return sum(self.level.values()) + self.removed

    @property
    def score(self) -> float:
        """How good it is."""
        return round(self.saving - self.cost - HINGE * self.hinges - self.lost, _DIGITS)


@dataclass(frozen=True, slots=True, eq=False)
class Row:
    """A line that was tried both ways."""

    line: Line
    best: Way
    other: Way
    """The opposite way, which is no better."""


def ranked(recipe: Recipe, tell: Callable[[str], None] = lambda text: None) -> tuple[Row, ...]:
    """All lines that are tried, best first; those that fold neither way stand last."""
    brief = replace(recipe.fold, time_limit=min(recipe.fold.time_limit, SEARCH))
    # A posture that is still to be chosen is chosen for the best direction.
    posture = "open" if recipe.print.posture == "auto" else recipe.print.posture
    recipe = replace(recipe, fold=brief, print=replace(recipe.print, posture=posture))
    # Thinner plates save more space: directions are compared at the thickness that is asked for, while one folds so.
    rows = _tried(replace(recipe, print=replace(recipe.print, may_thin=False)), tell)
    return _tried(recipe, tell) if recipe.print.may_thin and rows[0].best.solution is None else rows


def settled(recipe: Recipe) -> Recipe:
    """The recipe with the best direction, and why it is that one, where it names none.

    Raises:
        FoldingError: it folds along no direction that is tried.
    """
    if recipe.direction is not None:
        return recipe
    rows = ranked(recipe)
    best = rows[0].best
    if best.solution is None:
        raise FoldingError(_refused(recipe, rows))
    return replace(recipe, direction=best.direction, why=_why(rows))


def lacks(way: Way, best: Way) -> str:
    """What makes a way that folds worse than the best; empty where nothing does."""
    told = [f"takes {_listed(way.gone)} away"] if way.removed > best.removed else []
    told += [f"lays {_listed(tuple(way.level))} level"] if way.lost > best.lost and way.level else []
    told += _difference(best.saving - way.saving, "saves {:.0f} % less", "saves {:.0f} % more")
    told += _difference(way.cost - best.cost, "costs {:.2f} more", "costs {:.2f} less", 1.0)
    more = way.hinges - best.hinges
    told += [f"{abs(more)} hinge{'s' * (abs(more) > 1)} {'more' if more > 0 else 'fewer'}"] if more else []
    return ", ".join(told)


def losses(way: Way) -> str:
    """What the fold does without, or lays level; empty where all is there."""
    taken = [f"taken away ({_listed(way.gone)})"] if way.gone else []
    return " or ".join([*taken, *([f"laid level ({_listed(tuple(way.level))})"] if way.level else [])])


def _listed(names: tuple[str, ...]) -> str:
    return ", ".join(names) if len(names) < 4 else f"{', '.join(names[:2])} and {len(names) - 2} more"


def _difference(amount: float, more: str, less: str, unit: float = 100.0) -> list[str]:
    return [(more if amount > 0 else less).format(abs(amount) * unit)] if abs(amount) >= _WORTH_SAYING else []


def _tried(recipe: Recipe, tell: Callable[[str], None]) -> tuple[Row, ...]:
    of = lines(recipe)
    frame = main_frame(of)
    rows = []
    for line in of:
        ways = []
        for direction in (line.direction, 0.0 - line.direction):
            tell(f"trying {title(direction)}")
            ways.append(_way(recipe, direction, frame))
        best, other = sorted(ways, key=_order)
        rows.append(Row(line, best, other))
    return tuple(sorted(rows, key=lambda row: _order(row.best)))


def _way(recipe: Recipe, direction: Array, frame: Array) -> Way:
    try:
        solution = along(recipe, direction)
    except FoldfabError as error:
        # Of an error on the scaffold only the reason: the rest advises on other directions.
        reason = error.__cause__ if isinstance(error, AbstractionError) and error.__cause__ else error
        return Way(direction, " ".join(str(reason).split()))
    opened = _least(solution, 0.0, [np.eye(3), frame])
    folded = _least(solution, 1.0, _frames_along(direction, frame))
    way = Way(direction, "", solution, opened, folded, turned(solution.scaffold), _removed(solution))
    if way.lost <= MOST_LOST:
        return way
    return Way(direction, f"what folds is another piece: {100 * way.lost:.0f} % of this one is {losses(way)}")


def _removed(solution: FoldSolution) -> float:
    """The share of the area of all parts that is taken away."""
    gone = {m.patch for m in solution.modifications if m.is_deleted}
    scaffold = solution.scaffold
    area = sum(patch.area for patch in scaffold.patches if patch.name in gone)
    sheets = sum(float(part.size.prod() / part.size.min()) for part in scaffold.recipe.parts)
    return area / (sheets * scaffold.scale**2)


def _least(solution: FoldSolution, time: float, frames: list[Array]) -> tuple[float, float, float]:
    """The size of the smallest of the boxes around everything along these frames' rows."""
    from foldfab.folding.kinematics import size_at

    turn = solution.scaffold.rotation.T
    sizes = [size_at(solution, time, frame @ turn) for frame in frames]
    x, y, z = min(sizes, key=lambda size: round(float(size.prod()), 6)).tolist()
    return x, y, z


def _frames_along(direction: Array, frame: Array) -> list[Array]:
    """Frames whose last row is the direction and whose first is an axis, or one of the furniture's own, across it."""
    from foldfab.geometry.rotation import upright

    sides = [row for row in (*np.eye(3), *frame) if is_across(row, direction)] or [upright(direction)[0]]
    found = []
    for row in sides:
        side = row - (row @ direction) * direction
        side /= np.linalg.norm(side)
        found.append(np.stack([side, np.cross(direction, side), direction]))
    return found


def _order(way: Way) -> tuple[bool, float]:
    return way.solution is None, -way.score


def _why(rows: tuple[Row, ...]) -> str:
    best, *rest = [row.best for row in rows if row.best.solution is not None]
    told = f"direction {best.name} was chosen of {2 * len(rows)}: it saves {100 * best.saving:.0f} % of the space"
    told += f" at cost {best.cost:.2f} with {best.hinges or 'no'} hinge{'s' * (best.hinges != 1)} inserted"
    if best.lost >= _WORTH_SAYING:
        told += f", though {100 * best.lost:.0f} % of it is {losses(best)}"
    if not rest:
        return f"{told}; nothing folds along the others"
    return f"{told}; {rest[0].name} would be next ({lacks(rest[0], best) or 'just as good'})"


def _refused(recipe: Recipe, rows: tuple[Row, ...]) -> str:
    more = len(rows) - 3
    others = f" and none of {2 * more} along its parts" if more else ""
    reasons = [f"{way.name}: {way.problem}" for row in rows for way in (row.best, row.other)]
    return f"{recipe.name} folds along none of the six axis directions{others}\n  " + "\n  ".join(reasons)

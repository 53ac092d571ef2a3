"""The folding options of each patch as one table: its lanes, with each window of the patch, and its deletion last.

Prices are eq. 3 weighted by eq. 1; in the search deletion counts many times its price, and options of equal price are
told apart by small preferences.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from foldfab.folding import basic
from foldfab.folding.basic import Option
from foldfab.folding.conflict import windows_table
from foldfab.folding.lanes import Lane
from foldfab.folding.problem import Problem, demanding
from foldfab.folding.prospects import Prospects
from foldfab.folding.repertoire import awkwardness
from foldfab.geometry.arrays import Array, Bools

DELETION = 10.0
"""What every deletion counts in the search beyond eq. 3, more than all of eq. 1 can be: nobody wants a shelf without
its wall because that is cheaper than a hinge. So as few patches as possible are deleted, and of such solutions the
cheapest is taken. The cost that is reported is the paper's."""
PREFERENCE = 1e-6
"""Weight of the preferences that decide between options of equal cost: small plinths, staying within the outline."""

Alike = Literal["this", "wider windows", "any window", "any fall"]
"""Which options do the same as one: itself, its lane with wider windows or any, or whatever lets the base come down."""


@dataclass(frozen=True, slots=True, eq=False)
class Options:
    """The options of one patch in some surroundings."""

    patch: str
    lanes: tuple[Lane, ...]
    price: Array
    """(n,) λ · eq. 3."""
    weight: Array
    """(n,) what each counts in the search; infinite where it is out of the question."""
    windows: tuple[tuple[int, int], ...]

    def __getitem__(self, index: int) -> Option:
        place, price = self.place(index), float(self.price[index])
        return Option(place[0].variant, place[1], price) if place is not None else Option(None, (0, 0), price)

    def place(self, index: int) -> tuple[Lane, tuple[int, int]] | None:
        """The lane and the window of an option; None where it deletes the patch."""
        if index == len(self.price) - 1:
            return None
        lane, window = divmod(index, len(self.windows))
        return self.lanes[lane], self.windows[window]

    def has(self, place: tuple[Lane, tuple[int, int]] | None) -> bool:
        """Whether the lane of an option is one of these; deletion always is."""
        return place is None or place[0] in self.lanes

    def index(self, place: tuple[Lane, tuple[int, int]] | None) -> int:
        """The option of a lane and a window."""
        if place is None:
            return len(self.price) - 1
        return self.lanes.index(place[0]) * len(self.windows) + self.windows.index(place[1])

    def like(self, index: int, alike: Alike, depth: float = np.inf) -> list[int]:
        """The options that do what one does: of the same lane and of any window, or of windows that hold its own.

        With "any fall" those of all lanes by which the far base comes past `depth` mm, or moves alike where that is
        infinite.
        """
        if alike == "any fall":
            return self._falling(index, depth)
        if alike == "this" or index == len(self.price) - 1:
            return [index]
        lane, own = divmod(index, len(self.windows))
        low, high = self.windows[own] if alike == "wider windows" else (len(self.windows), -1)
        return [lane * len(self.windows) + w for w, (a, b) in enumerate(self.windows) if a <= low and b >= high]

    def _falling(self, index: int, depth: float) -> list[int]:
        place = self.place(index)
        if np.isfinite(depth):
            lanes = [k for k, x in enumerate(self.lanes) if x.comes_past(depth)]
        elif place is not None:
            own = place[0].variant
            lanes = [k for k, x in enumerate(self.lanes) if replace(x.variant, side=own.side, hinged=own.hinged) == own]
        else:
            return [index]
        found = [k * len(self.windows) + w for k in lanes for w in range(len(self.windows))]
        # Where the patch is gone, nothing keeps the base from coming down.
        return [*found, len(self.price) - 1] if np.isfinite(depth) else found


def options_of(problem: Problem, found: Prospects, offset: Array) -> dict[str, Options]:
    """The options of every patch of a unit that has been carried by `offset` (3,) since the open posture, mm."""
    windows = basic.windows(problem.options.shrink_steps)
    # Priced all together: there are few options of any one patch.
    price, weight = _priced(problem, [x for many in found.lanes.values() for x in many], found.blocked, windows, offset)
    made, start = {}, 0
    for patch, lanes in found.lanes.items():
        own = slice(start, start + len(lanes))
        made[patch] = _options(problem, patch, lanes, price[own], weight[own], windows)
        start = own.stop
    return made


def _priced(
    problem: Problem, every: list[Lane], blocked: Mapping[int, Bools], windows: tuple[tuple[int, int], ...],
    offset: Array,
) -> tuple[Array, Array]:  # fmt: skip
    """What each lane costs with each window (lanes, windows), and what that counts in the search."""
    options, steps = problem.options, problem.options.shrink_steps
    sites = [problem.sites[x.patch] for x in every]
    kept = np.array([b - a for a, b in windows]) / steps
    splits = options.alpha * np.array([x.variant.hinges for x in every], dtype=np.float64) / options.max_hinges
    importance = np.array([site.importance for site in sites])
    price = importance[:, None] * (splits[:, None] + (1 - options.alpha) * (1 - kept) ** 2)
    taken = np.array([blocked[x.number] for x in every], dtype=np.float32).reshape(len(every), steps)
    out = taken @ windows_table(windows, steps).T > 0
    narrow = _narrow(problem, windows)
    out |= np.array([narrow[x.patch] for x in every], dtype=bool).reshape(out.shape)
    held = np.array([x.variant.hinged for x in every]).reshape(-1, 2)
    is_cut = np.any(held != np.array(basic.WHOLE), axis=1)[:, None]
    first, last = np.array(windows).T / steps
    # What is left of an interrupted hinge must be within the window.
    out |= is_cut & ((first > held[:, :1]) | (last < held[:, 1:]))
    extra = PREFERENCE * awkwardness(problem, every, offset)[:, None]
    return price, np.where(out, np.inf, price + extra)


def _narrow(problem: Problem, windows: tuple[tuple[int, int], ...]) -> Mapping[str, Bools]:
    """By patch, which of its windows are too narrow for a hinge."""
    if not problem.narrow:
        found = basic.too_narrow(list(problem.sites.values()), windows, problem.options.shrink_steps, problem.thickness)
        problem.narrow.update(zip(problem.sites, found, strict=True))
    return problem.narrow


def _options(
    problem: Problem, patch: str, lanes: tuple[Lane, ...], price: Array, weight: Array,
    windows: tuple[tuple[int, int], ...],
) -> Options:  # fmt: skip
    gone = problem.sites[patch].importance * basic.cost(0, 0.0, problem.options)
    weights = np.append(weight, DELETION + gone)
    made = Options(patch, lanes, np.append(price, gone), weights, windows)
    weights[~_allowed(problem, made)] = np.inf
    return made


def _allowed(problem: Problem, options: Options) -> Bools:
    """Which options (n,) the recipe allows: those that fit what is pinned, and nothing that is forbidden."""
    count, steps = len(options.price), problem.options.shrink_steps
    allowed = np.ones(count, dtype=bool)
    for part in demanding(problem, options.patch):
        for i in range(count):
            v, (a, b) = options[i].variant, options[i].window
            what = (v.mechanism, v.hinges, v.side, (a / steps, b / steps)) if v else ("deleted", 0, None, (0.0, 0.0))
            allowed[i] &= part.allows(*what)
    return allowed

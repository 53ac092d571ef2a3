"""How the bases of a unit come down, and how its chains follow (sections 5.2 and 5.4, figure 11a; with thickness 5.6).

Folded, a chain takes up its stack height s_c; the folded heights of the bases are the least ones with
z_b - z_a ≥ s_c for each chain c from a up to b, the longest paths from the lowest base. What a chain lacks to its
bases' distance is made up by plinths under its hinges, so that it ends flat.

A press comes down at level p: base b, whose whole way is e_b, starts to move when p reaches e_b and then moves with
it, so higher bases always start before lower ones. The chain that starts a section leads: p follows its exact motion,
the snap of the thick accordion included, and the second one of an accordion that leans, where it turns to a zig-zag;
so the chain whose second snap is highest leads. Chains that cannot follow exactly are off by their *play*.

Between samples all moves straight while hinges turn on circles, so samples are taken until that makes no difference.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from foldfab.folding.mechanism import descent, open_height, peak, reach, turn
from foldfab.folding.model import Chain
from foldfab.geometry.arrays import Array, Bools, Indices

SAME_LEVEL = 1e-6
"""Bases whose ways differ by less start together, mm."""
PLAY_SHARE = 0.45
"""Share of the clearance that one hinge may give."""
SAMPLES = 48
"""Samples of each section of a unit's fold."""
SETTLED = 4
"""Chains that snap differently move alike again when the leader has come this many times as far as to its snap."""
SNAP_DIGITS = 6
"""To how many digits of mm a second snap is told: less is rounding."""
CLIMB = 10
"""Samples up to the snap."""
TURNED = np.array([0.0, 0.02, 0.04, 0.07, 0.1])
"""How far beyond the turn of a leaning accordion more samples are taken: it hurries there."""
STRAIGHT = 0.04
"""How far a chain may be from its base halfway between two samples, mm: a little less than validity allows."""
REFINEMENTS = 6
"""How often intervals between samples are halved; each time what is left is about a quarter."""


@dataclass(frozen=True, slots=True, eq=False)
class Motion:
    """The sampled motion of one unit."""

    samples: Array
    """(k,) local times from 0 to 1."""
    shift: dict[str, Array]
    """By base of the unit, (k, 3) translation, mm; 0 for its lowest base."""
    fold: dict[str, Array]
    """By patch, (k,) progress."""
    play: dict[str, Array]
    """By patch, (k,) mm that its hinges have to give."""
    path: float
    """Length of the longest way that a panel's end sweeps, mm: the measure of the unit's time."""


def ways(bases: tuple[str, ...], least: Mapping[tuple[str, str], float], clear: Mapping[tuple[str, str], float],
         level: Mapping[str, float]) -> dict[str, float]:  # fmt: skip
    """How far each base comes down, e_b ≥ 0, mm.

    Args:
        bases: lowest first.
        least: by (lower, upper) the least clear height that may remain.
        clear: by (lower, upper) the clear height now.
        level: by base, the height it stands above the lowest base, to which a base without anything below comes down.
    """
    way: dict[str, float] = {}
    under: dict[str, list[str]] = {}
    for a, b in least:
        under.setdefault(b, []).append(a)
    for base in bases:
        below = [way[a] + clear[a, base] - least[a, base] for a in under.get(base, ()) if a in way]
        way[base] = max(min(below) if below else level[base], 0.0)
    return way


def in_place(bases: tuple[str, ...], way: Mapping[str, float], chains: tuple[Chain, ...], gap: float) -> Motion:
    """The motion of a unit whose bases come straight down; T-scaffolds fold evenly meanwhile.

    `gap` is the clearance, by which hinges can give where chains snap differently.
    """
    held = [c for c in chains if c.far is not None]
    tips = [c for c in chains if c.far is None]
    levels = _levels([way[b] for b in bases if way[b] > SAME_LEVEL]) if held else []
    if not levels:
        return _tips_only(bases, tips)
    sections = [_section(i, levels, way, held, gap) for i in range(len(levels))]
    down, fold, play = _followed(bases, way, levels, sections, held)
    for _ in range(REFINEMENTS):
        bent = _bent(held, down, fold, play)
        if not bent.any():
            break
        sections = _refined(sections, bent)
        down, fold, play = _followed(bases, way, levels, sections, held)
    path = sum(s.path for s in sections)
    samples = _times(sections)
    for chain in tips:
        fold[chain.patch], play[chain.patch] = samples, np.zeros_like(samples)
        path = max(path, float(chain.lengths.sum()) * np.pi / 2)
    shift = {b: np.stack([np.zeros_like(d), np.zeros_like(d), d], axis=1) for b, d in down.items()}
    return Motion(samples, shift, fold, play, path)


def slanted(bases: tuple[str, ...], chains: tuple[Chain, ...]) -> Motion:
    """The motion of a unit of parallel chains that drag their upper base through one circular arc."""
    lead = chains[0]
    length, turned = float(lead.lengths.sum()), np.pi / 2 + abs(lead.lean)
    count = max(SAMPLES, int(np.ceil(turned * np.sqrt(length / (8 * STRAIGHT)))))
    s = np.linspace(0.0, 1.0, count + 1)
    way = reach(lead, s)
    way = (way - way[0]) @ lead.plane
    shift = {base: (way if base == lead.far else np.zeros_like(way)) for base in bases}
    path = length * np.pi / 2
    return Motion(s, shift, {c.patch: s for c in chains}, {c.patch: np.zeros_like(s) for c in chains}, path)


def play_limit(chain: Chain, gap: float) -> float:
    """How far the hinges of a chain can give all together, mm, for a clearance `gap`."""
    return PLAY_SHARE * gap * (len(chain.lengths) + 1)


def follow_down(chain: Chain, drop: Array) -> Array:
    """Progress (k,) at which the chain's far end has come down by `drop` (k,) mm, on the falling side of its snap."""
    s, height, top = descent(chain)
    found: Array = np.interp(np.asarray(drop), -np.minimum.accumulate(height[top:]), s[top:])
    return found


@dataclass(frozen=True, slots=True, eq=False)
class _Section:
    """What happens while the press is at one level: from the start of the bases there to the start of the next ones."""

    leader: Chain
    progress: Array
    climb: Array
    """(k,) 0 where the section starts, 1 where the last of the starting chains snaps, and more beyond."""
    whole: float
    """How far the leader's far base comes down in all, mm."""
    more: float
    """How much higher than by the leader's own snap bases rise, mm."""
    path: float

    @property
    def press(self) -> Array:
        """(k,) its level."""
        press: Array = self.whole + reach(self.leader, self.progress)[:, 1] - open_height(self.leader)
        if self.more:
            climb = self.climb
            press += self.more * np.where(climb < 1, climb**2 * (3 - 2 * climb), _fade(climb))
        return press


def _levels(values: list[float]) -> list[float]:
    levels: list[float] = []
    for value in sorted(values, reverse=True):
        if not levels or levels[-1] - value > SAME_LEVEL:
            levels.append(value)
    return levels


def _starts_at(chain: Chain, way: Mapping[str, float], level: float) -> bool:
    return chain.far is not None and abs(way[chain.far] - level) <= SAME_LEVEL


def _section(i: int, levels: list[float], way: Mapping[str, float], held: list[Chain], gap: float) -> _Section:
    starting = [c for c in held if _starts_at(c, way, levels[i])]
    leader = _leader(starting or [c for c in held if _is_folding(c, way, levels[i])], way)
    until = levels[i + 1] if i + 1 < len(levels) else 0.0
    whole = way[leader.far or ""]
    is_done = until - way[leader.anchor] <= SAME_LEVEL
    begin = 0.0 if starting else float(follow_down(leader, np.array([whole - levels[i]]))[0])
    end = 1.0 if is_done else float(follow_down(leader, np.array([whole - until]))[0])
    snaps = [peak(c) for c in starting]
    crest = max((place for _, place in snaps), default=0.0)
    rise, at = peak(leader) if starting else (0.0, begin)
    climb = np.linspace(0.0, 1.0, CLIMB + 1)[:-1] if crest > 0 else np.zeros(0)
    down = np.linspace(at, end, SAMPLES + 1)
    if crest > 0:
        down = np.unique(np.concatenate([down, np.linspace(at, min(at + (SETTLED - 1) * crest, end), 4 * SETTLED)]))
    down = np.unique(np.concatenate([down, _turns(leader, held, way, at, end)]))
    s = np.concatenate([at * climb, down])
    climb = np.concatenate([climb, 1 + (down - at) / crest if crest > 0 else np.full(len(down), np.inf)])
    more = _shared_rise([r for r, _ in snaps], [play_limit(c, gap) for c in starting]) - rise if crest > 0 else 0.0
    path = float(leader.lengths.max()) * np.pi / 2 * (end - begin) * len(leader.lengths)
    return _Section(leader, s, climb, whole, more, path)


def _followed(
    bases: tuple[str, ...], way: Mapping[str, float], levels: list[float], sections: list[_Section], held: list[Chain]
) -> tuple[dict[str, Array], dict[str, Array], dict[str, Array]]:
    """By base how it comes down, and by patch the progress and the play of its chain, (k,) each."""
    press = np.concatenate([s.press for s in sections])
    index = np.concatenate([np.full(len(s.progress), i) for i, s in enumerate(sections)])
    climb = np.concatenate([s.climb for s in sections])
    down = {b: _shift(b, way, levels, press, index) for b in bases}
    fold, play = {}, {}
    for chain in held:
        fold[chain.patch], play[chain.patch] = _follow(chain, sections, down, climb, index)
    return down, fold, play


def _bent(held: list[Chain], down: Mapping[str, Array], fold: Mapping[str, Array], play: Mapping[str, Array]) -> Bools:
    """(k - 1,) the intervals halfway through which a chain and its bases are apart."""
    found = np.zeros(len(next(iter(down.values()))) - 1, dtype=bool)
    for chain in held:
        drop, s, give = map(
            _halfway, (down[chain.anchor] - down[chain.far or ""], fold[chain.patch], play[chain.patch])
        )
        found |= np.abs(drop + give + reach(chain, s)[:, 1] - open_height(chain)) > STRAIGHT
    return found


def _halfway(values: Array) -> Array:
    halfway: Array = (values[1:] + values[:-1]) / 2
    return halfway


def _refined(sections: list[_Section], bent: Bools) -> list[_Section]:
    """The sections with another sample in the middle of each of these intervals."""
    made, start = [], 0
    for section in sections:
        count = len(section.progress)
        at = np.nonzero(bent[start : start + count - 1])[0]
        progress, climb = (
            np.insert(values, at + 1, _halfway(values)[at]) for values in (section.progress, section.climb)
        )
        made.append(replace(section, progress=progress, climb=climb))
        start += count
    return made


def _turns(leader: Chain, held: list[Chain], way: Mapping[str, float], at: float, end: float) -> Array:
    """Progress of the leader, between two, at which chains turn from linkage to zig-zag and soon after."""
    places = [np.zeros(0)]
    for chain in held:
        own = turn(chain)
        if own is not None and chain.far is not None:
            wanted = own + TURNED
            drop = open_height(chain) - reach(chain, wanted)[:, 1]
            later = way[leader.far or ""] - way[chain.far]
            places.append(wanted if chain is leader else follow_down(leader, later + drop))
    found = np.concatenate(places)
    return found[(at < found) & (found < end)]


def _fade(climb: Array) -> Array:
    """1 at the snap, 0 where all chains are past it."""
    faded: Array = np.clip(1 - (climb - 1) / (SETTLED - 1), 0.0, 1.0) ** 2
    return faded


def _shared_rise(rises: list[float], limits: list[float]) -> float:
    """How far bases rise so that the play of every chain, as a share of what it can give, stays small."""
    least = max(r - limit for r, limit in zip(rises, limits, strict=True))
    most = min(r + limit for r, limit in zip(rises, limits, strict=True))
    return rises[0] if len(set(np.round(rises, 9))) == 1 else (least + most) / 2


def _leader(many: list[Chain], way: Mapping[str, float]) -> Chain:
    return max(many, key=lambda c: (way[c.anchor], _second_snap(c), -len(c.lengths), c.patch))


def _second_snap(chain: Chain) -> float:
    """How far the far end rises again after it has begun to fall, mm."""
    _, height, top = descent(chain)
    return round(float((height[top:] - np.minimum.accumulate(height[top:])).max()), SNAP_DIGITS)


def _falling(chain: Chain) -> tuple[Array, Array]:
    """Progress (n,) past its snap and how far the far end has then come down (n,), which never gets less.

    Where it rises for a second time it is taken to come down evenly from as high as it will rise until it is as low
    as it has been: no chain ever jumps, and what that is off is play.
    """
    s, height, top = descent(chain)
    s, height = s[top:], height[top:]
    if _second_snap(chain):
        lowest = np.minimum.accumulate(height)
        rises = np.nonzero(height > lowest)[0]
        crest = float(height[rises].max())
        first = int(np.nonzero(height[: rises[0]] >= crest)[0][-1])
        last = min(int(rises[-1]) + 1, len(s) - 1)
        height = height.copy()
        height[first : last + 1] = np.interp(s[first : last + 1], s[[first, last]], height[[first, last]])
    return s, -np.minimum.accumulate(height)


def _is_folding(chain: Chain, way: Mapping[str, float], level: float) -> bool:
    """Whether the chain is on its way while the press passes this level."""
    return chain.far is not None and way[chain.anchor] < level - SAME_LEVEL < way[chain.far]


def _shift(base: str, way: Mapping[str, float], levels: list[float], press: Array, index: Indices) -> Array:
    start = next((i for i, level in enumerate(levels) if abs(way[base] - level) <= SAME_LEVEL), None)
    return np.zeros_like(press) if start is None else np.where(index >= start, press - way[base], 0.0)


def _follow(
    chain: Chain, sections: list[_Section], down: Mapping[str, Array], climb: Array, index: Indices
) -> tuple[Array, Array]:
    """Progress and play of one chain, given how its two bases move.

    While the section that it starts in climbs, so does the chain, to its own snap; after it, what its snap is higher
    than the press fades away, so that no chain ever jumps.
    """
    assert chain.far is not None
    drop = down[chain.anchor] - down[chain.far]
    s, height, top = descent(chain)
    moving = np.nonzero(np.abs(drop) > 1e-9)[0]
    own = int(index[moving[0]]) if len(moving) else 0
    is_own, fade = index == own, _fade(climb)
    crest = float((-drop[is_own]).max()) if top else 0.0
    lifted = -drop + np.where(is_own, (height[top] - crest) * fade, 0.0)
    past, fallen = _falling(chain)
    found = np.interp(-lifted, fallen, past)
    found = np.where(is_own & (climb < 1), s[top] * np.clip(climb, 0.0, 1.0), found)
    if _is_twin(chain, sections[own].leader):
        found[is_own] = sections[own].progress
    found = np.where(index < own, 0.0, found)
    found[-1] = 1.0
    return found, -drop - (reach(chain, found)[:, 1] - open_height(chain))


def _is_twin(a: Chain, b: Chain) -> bool:
    """Whether two chains move alike, up to mirroring."""
    return (
        len(a.lengths) == len(b.lengths)
        and abs(abs(a.lean) - abs(b.lean)) < 1e-9
        and all(abs(x - y) <= 1e-6 for x, y in zip(sorted(a.shape.lengths), sorted(b.shape.lengths), strict=True))
    )


def _times(sections: list[_Section]) -> Array:
    steps = []
    for section in sections:
        # A leader without a snap of its own stands still while the others climb.
        step = np.diff(section.progress, prepend=section.progress[0])
        step = np.maximum(step, 1e-4)
        steps.append(step * section.path / float(step.sum()))
    steps[0][0] = 0.0
    clock = np.cumsum(np.concatenate(steps))
    times: Array = clock / clock[-1]
    return times


def _tips_only(bases: tuple[str, ...], tips: list[Chain]) -> Motion:
    s = np.linspace(0.0, 1.0, SAMPLES + 1)
    path = max((float(c.lengths.sum()) * np.pi / 2 for c in tips), default=1.0)
    still = np.zeros((len(s), 3))
    return Motion(
        s, dict.fromkeys(bases, still), {c.patch: s for c in tips}, {c.patch: np.zeros_like(s) for c in tips}, path
    )

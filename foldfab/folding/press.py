"""How the bases of a unit come down, and how its chains follow (sections 5.2 and 5.4, figure 11a; with thickness 5.6).

Folded, a chain takes up its stack height s_c; the folded heights of the bases are the least ones with
z_b - z_a ≥ s_c for each chain c from a up to b, the longest paths from the lowest base. What a chain lacks to its
bases' distance is made up by plinths under its hinges, so that it ends flat.

A press comes down at level p: base b, whose whole way is e_b, starts to move when p reaches e_b and then moves with
it, so higher bases always start before lower ones. The chain that starts a section leads: p follows its exact motion,
the snap of the thick accordion included. Chains that cannot follow exactly are off by their *play*.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from foldfab.folding.mechanism import peak, reach
from foldfab.folding.model import Chain
from foldfab.geometry.arrays import Array, Bools, Indices

SAME_LEVEL = 1e-6
"""Bases whose ways differ by less start together, mm."""
SAMPLES = 48
"""Samples of each section of a unit's fold."""
TABLE = 385
"""Samples of the table by which a chain's motion is inverted."""


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
    for base in bases:
        below = [way[a] + clear[a, b] - least[a, b] for a, b in least if b == base and a in way]
        way[base] = min(below) if below else level[base]
    return way


def in_place(bases: tuple[str, ...], way: Mapping[str, float], chains: tuple[Chain, ...]) -> Motion:
    """The motion of a unit whose bases come straight down; T-scaffolds fold evenly meanwhile."""
    held = [c for c in chains if c.far is not None]
    tips = [c for c in chains if c.far is None]
    levels = _levels([way[b] for b in bases if way[b] > SAME_LEVEL]) if held else []
    if not levels:
        return _tips_only(bases, tips)
    sections = [_section(i, levels, way, held) for i in range(len(levels))]
    press = np.concatenate([s.press for s in sections])
    index = np.concatenate([np.full(len(s.press), i) for i, s in enumerate(sections)])
    lead = np.concatenate([s.rising for s in sections])
    down = {b: _shift(b, way, levels, press, index) for b in bases}
    fold, play = {}, {}
    for chain in held:
        fold[chain.patch], play[chain.patch] = _follow(chain, sections, down, lead, index)
    path = sum(s.path for s in sections)
    samples = _times(sections)
    for chain in tips:
        fold[chain.patch], play[chain.patch] = samples, np.zeros_like(samples)
        path = max(path, float(chain.lengths.sum()) * np.pi / 2)
    shift = {b: np.stack([np.zeros_like(d), np.zeros_like(d), d], axis=1) for b, d in down.items()}
    return Motion(samples, shift, fold, play, path)


def slanted(bases: tuple[str, ...], chains: tuple[Chain, ...]) -> Motion:
    """The motion of a unit of parallel chains that drag their upper base through one circular arc."""
    s = np.linspace(0.0, 1.0, SAMPLES + 1)
    lead = chains[0]
    way = reach(lead, s)
    way = (way - way[0]) @ np.stack([lead.across, lead.rise])
    shift = {base: (way if base == lead.far else np.zeros_like(way)) for base in bases}
    path = float(lead.lengths.sum()) * np.pi / 2
    return Motion(s, shift, {c.patch: s for c in chains}, {c.patch: np.zeros_like(s) for c in chains}, path)


def follow_down(chain: Chain, drop: Array) -> Array:
    """Progress (k,) at which the chain's far end has come down by `drop` (k,) mm, on the falling side of its snap."""
    s = np.linspace(0.0, 1.0, TABLE)
    height = reach(chain, s)[:, 1]
    top = int(np.argmax(height))
    falling = np.minimum.accumulate(height[top:])
    found: Array = np.interp(-(height[0] - np.asarray(drop)), -falling, s[top:])
    return found


@dataclass(frozen=True, slots=True, eq=False)
class _Section:
    """What happens while the press is at one level: from the start of the bases there to the start of the next ones."""

    leader: Chain
    progress: Array
    press: Array
    rising: Bools
    """(k,) whether the leader is still before its snap."""
    is_exact: bool
    """Whether the press follows the leader to the letter."""
    path: float


def _levels(values: list[float]) -> list[float]:
    levels: list[float] = []
    for value in sorted(values, reverse=True):
        if not levels or levels[-1] - value > SAME_LEVEL:
            levels.append(value)
    return levels


def _starts_at(chain: Chain, way: Mapping[str, float], level: float) -> bool:
    return chain.far is not None and abs(way[chain.far] - level) <= SAME_LEVEL


def _section(i: int, levels: list[float], way: Mapping[str, float], held: list[Chain]) -> _Section:
    starting = [c for c in held if _starts_at(c, way, levels[i])]
    leader = _leader(starting or [c for c in held if _is_folding(c, way, levels[i])], way)
    until = levels[i + 1] if i + 1 < len(levels) else 0.0
    whole = way[leader.far or ""]
    is_done = until - way[leader.anchor] <= SAME_LEVEL
    begin = 0.0 if starting else float(follow_down(leader, np.array([whole - levels[i]]))[0])
    end = 1.0 if is_done else float(follow_down(leader, np.array([whole - until]))[0])
    rise, at = peak(leader)
    s = np.linspace(begin, end, SAMPLES + 1)
    if begin < at < end:
        s = np.unique(np.concatenate([s, np.linspace(0.0, min(2 * at, end), 9)]))
    height = reach(leader, s)[:, 1]
    press = whole + height - reach(leader, np.zeros(1))[0, 1]
    peaks = [peak(c)[0] for c in starting] or [rise]
    excess = rise - (min(peaks) + max(peaks)) / 2
    if at > 0 and starting:
        press -= excess * np.clip(1 - ((s - at) / np.where(s < at, at, 3 * at)) ** 2, 0, None) ** 2
    path = float(leader.lengths.max()) * np.pi / 2 * (end - begin) * len(leader.lengths)
    return _Section(leader, s, press, (s < at) & bool(starting), bool(starting) and abs(excess) < 1e-9, path)


def _leader(many: list[Chain], way: Mapping[str, float]) -> Chain:
    return max(many, key=lambda c: (way[c.anchor], -len(c.lengths), c.patch))


def _is_folding(chain: Chain, way: Mapping[str, float], level: float) -> bool:
    """Whether the chain is on its way while the press passes this level."""
    return chain.far is not None and way[chain.anchor] < level - SAME_LEVEL < way[chain.far]


def _shift(base: str, way: Mapping[str, float], levels: list[float], press: Array, index: Indices) -> Array:
    start = next((i for i, level in enumerate(levels) if abs(way[base] - level) <= SAME_LEVEL), None)
    return np.zeros_like(press) if start is None else np.where(index >= start, press - way[base], 0.0)


def _follow(
    chain: Chain, sections: list[_Section], down: Mapping[str, Array], rising: Bools, index: Indices
) -> tuple[Array, Array]:
    """Progress and play of one chain, given how its two bases move."""
    assert chain.far is not None
    drop = down[chain.anchor] - down[chain.far]
    s = np.linspace(0.0, 1.0, TABLE)
    height = reach(chain, s)[:, 1] - reach(chain, np.zeros(1))[0, 1]
    top = int(np.argmax(height))
    found = np.interp(drop, -np.minimum.accumulate(height[top:]), s[top:])
    moving = np.nonzero(np.abs(drop) > 1e-9)[0]
    own = int(index[moving[0]]) if len(moving) else 0
    found = np.where(index < own, 0.0, found)
    if top:
        climbing = rising & (index == own)
        found[climbing] = np.interp(-drop[climbing], np.maximum.accumulate(height[: top + 1]), s[: top + 1])
    section = sections[own]
    if section.is_exact and _is_twin(chain, section.leader):
        found[index == own] = section.progress
    found[-1] = 1.0
    return found, -drop - (reach(chain, found)[:, 1] - reach(chain, np.zeros(1))[0, 1])


def _is_twin(a: Chain, b: Chain) -> bool:
    """Whether two chains move alike, up to mirroring."""
    return (
        len(a.lengths) == len(b.lengths)
        and abs(abs(a.lean) - abs(b.lean)) < 1e-9
        and bool(np.allclose(np.sort(a.lengths), np.sort(b.lengths), atol=1e-6, rtol=0))
    )


def _times(sections: list[_Section]) -> Array:
    steps = [
        np.diff(s.progress, prepend=s.progress[0]) * s.path / max(float(np.ptp(s.progress)), 1e-9) for s in sections
    ]
    for step in steps[1:]:
        step[0] = 1e-6 * float(step.sum())
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

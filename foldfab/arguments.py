"""What the command line takes: commands, and an option for each field of a recipe."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Mapping, Sequence

Run = Callable[[argparse.Namespace], int]
"""Runs a command and returns its exit status."""

MOST_ALTERNATIVES = 20

_OPTIONS: tuple[tuple[str, str, str], ...] = (
    ("--direction", "D", 'folding direction: an axis such as -z, a vector such as 0,0,-1, or "auto"'),
    ("--posture", "P", "print it open, folded, edge (folded, hinge axes vertical), plate (loose parts), or auto"),
    ("--printer", "NAME", "a known printer such as prusa-mk4, or a build volume such as 200x200x180"),
    ("--scale", "S", 'print size over true size: "fit", a number, or a ratio such as 1:5'),
    ("--hinge", "STYLE", "cone or clip, printed in place; filament, screw-m2 or screw-m3, pinned after printing"),
    ("--clearance", "MM", "gap that a hinge is printed with, 0.15 to 1; auto: by calibration or nozzle"),
    ("--shape", "S", "plain plates, or own: as parts look that came with a shape, where they fold"),
    ("--nozzle", "MM", "diameter of the nozzle (0.4)"),
    ("--layer", "MM", "height of a layer (0.2)"),
    ("--material", "M", "pla, petg, abs or nylon"),
    ("--thickness", "MM", "thickness of plates and panels, 2 to 20; auto: 4, or less where only that folds"),
    ("--base-thickness", "MM", "thickness of base plates, where it is another"),
    ("--alpha", "A", "weight of inserted hinges (1) against shrinking (0)"),
    ("--max-hinges", "N", "most hinges that may be inserted in one patch, 1 to 9"),
    ("--shrink-steps", "N", "how many pieces a patch is cut into for shrinking, 1 to 20"),
    ("--ordering", "O", "greedy, as in the paper, or optimal: modifications and order chosen in one shot"),
    ("--collisions", "C", "swept: shapes that meet in time; or regions: the paper's own test"),
    ("--time-limit", "SECONDS", "of work on an ordinary machine, up to 3600"),
)
SWITCHES = ("slanting", "stay_in_box", "symmetry", "own_thickness", "latch", "split_shells")
_SHAPES = (
    ("--units", "U", "of a file of shapes: mm, cm, m or in; what it states, or a guess, where missing"),
    ("--up", "AXIS", "that points up in a file of shapes: x, y or z; its format's where missing"),
    ("--smallest", "MM", "bodies no longer than this are hardware, left out (2 %% of the furniture's longest side)"),
)
_SLICER = "--slicer"
_REPEATED = (
    ("--rigid", "NAME", "a part that must not get a hinge in its middle; may be given again for others"),
    ("--ignore", "NAME", "parts that are left out, such as cushion*; may be given again for others"),
)


def parser(run: Mapping[str, Run], version: type[argparse.Action]) -> argparse.ArgumentParser:
    """The parser of all commands; `run` holds by name what each does, and `version` tells the version."""
    made = argparse.ArgumentParser(
        prog="foldfab", description="Furniture becomes a print that folds flat.", allow_abbrev=False
    )
    made.add_argument("--version", action=version, nargs=0, help="show the version and exit")
    commands = made.add_subparsers(title="commands", metavar="COMMAND", required=True)
    making = _command(commands, run, "print", "fold a recipe's furniture and write a folder that prints")
    making.add_argument("-o", "--output", metavar="DIR", default="prints", help="where its folder goes (prints)")
    making.add_argument("--step", action="store_true", help="write a STEP file for CAD too, by build123d")
    folding = _command(commands, run, "fold", "only say what would be changed, in which order, at which cost")
    folding.add_argument("--json", action="store_true", help="print the facts as JSON")
    how_many = f"show the best K folds, 1 to {MOST_ALTERNATIVES}, and how they differ"
    folding.add_argument("--alternatives", metavar="K", type=_how_many, help=how_many)
    folding.add_argument(
        "--verify", action="store_true", help="try the fold out at every moment, apart from the search"
    )
    trying = _command(commands, run, "directions", "which directions it folds along, best first, with pictures")
    trying.add_argument(
        "-o", "--output", metavar="DIR", default="directions", help="where its folder goes (directions)"
    )
    trying.add_argument("--json", action="store_true", help="print the facts as JSON")
    comparing = _command(commands, run, "postures", "what each posture takes, by the slicer")
    understanding = _command(commands, run, "recipe", "write the recipe that a file is understood as")
    looking = "show no progress"
    told = (
        (trying, looking), (comparing, looking), (making, f"{looking} and no summary"), (folding, looking),
    )  # fmt: skip
    for command, quiet in (*told, (understanding, "no notes")):
        kinds = "STEP, GLB, glTF, OBJ, 3MF, STL, URDF, MJCF"
        what = f"a recipe (.json) or its name, a file of shapes ({kinds}), or a folder of STL files"
        command.add_argument("recipe", metavar="FILE", help=what)
        command.add_argument("-q", "--quiet", action="store_true", help=quiet)
        _add_options(command)
    _add_looking(commands, run)
    _add_calibrating(commands, run)
    return made


def _add_looking(commands: argparse._SubParsersAction[argparse.ArgumentParser], run: Mapping[str, Run]) -> None:
    checking = _command(commands, run, "check", "inspect a print folder from its files alone")
    checking.add_argument("folder", metavar="FOLDER", help="a folder that `foldfab print` wrote")
    checking.add_argument("--json", action="store_true", help="print the facts as JSON")
    slicing = "slice it with PrusaSlicer too: time, filament, support, repairs, outlines at hinges"
    checking.add_argument(_SLICER, metavar="=PATH", nargs="?", const="", help=slicing)
    _command(commands, run, "recipes", "list the recipes that foldfab ships")
    composing = _command(commands, run, "compose", "arrange furniture in a grid, as a recipe to measure foldfab by")
    composing.add_argument("kind", metavar="KIND", help="bench, building, hexagon or shelf")
    composing.add_argument("grid", metavar="GRID", help="columns x rows, such as 4x4; at most 32x32")
    composing.add_argument("-o", "--output", metavar="FILE", help="where the recipe goes (KIND-GRID.json, here)")


def _add_calibrating(commands: argparse._SubParsersAction[argparse.ArgumentParser], run: Mapping[str, Run]) -> None:
    trying = _command(commands, run, "coupon", "the same hinge in a row of clearances, to calibrate a printer by")
    trying.add_argument("--printer", metavar="NAME", required=True, help="a known printer or a build volume")
    trying.add_argument("--posture", metavar="P", default="open", help="how its hinges are printed: open or folded")
    trying.add_argument("--thickness", metavar="MM", default="4", help="thickness of its plates (4)")
    trying.add_argument("-o", "--output", metavar="DIR", default="prints", help="where its folder goes (prints)")
    keeping = _command(commands, run, "calibrate", "keep the clearance that a printer prints hinges well with")
    keeping.add_argument("--printer", metavar="NAME", required=True, help="a known printer or a build volume")
    keeping.add_argument("clearance", metavar="CLEARANCE", type=float, help="mm, 0.15 to 1")


def _command(
    commands: argparse._SubParsersAction[argparse.ArgumentParser],
    run: Mapping[str, Run],
    name: str,
    text: str,
) -> argparse.ArgumentParser:
    parser = commands.add_parser(name, help=text, description=text, allow_abbrev=False)
    parser.set_defaults(command=run[name])
    return parser


def _add_options(parser: argparse.ArgumentParser) -> None:
    """Options that replace the recipe's own; their values are judged by the recipe room, all at once."""
    group = parser.add_argument_group("options that replace the recipe's")
    for option, metavar, text in _OPTIONS:
        group.add_argument(option, metavar=metavar, help=text)
    for option, metavar, text in _REPEATED:
        group.add_argument(option, metavar=metavar, action="append", help=text)
    shapes = parser.add_argument_group("how files of shapes are read")
    for option, metavar, text in _SHAPES:
        shapes.add_argument(option, metavar=metavar, help=text, type=float if metavar == "MM" else str)
    shells = "shells of one body that do not touch are parts of their own"
    shapes.add_argument("--split-shells", action="store_true", default=None, help=shells)
    group.add_argument("--no-slanting", dest="slanting", action="store_false", default=None, help="fold in place only")
    group.add_argument("--stay-in-box", action="store_true", default=None, help="stay within the bounding box")
    group.add_argument(
        "--latch", action="store_true", default=None, help="grooves for pins of filament that hold base hinges open"
    )
    group.add_argument("--symmetry", action="store_true", default=None, help="treat mirrored parts alike")
    group.add_argument("--own-thickness", action="store_true", default=None, help="parts as thick as they are, or more")


def _how_many(text: str) -> int:
    if text not in map(str, range(1, MOST_ALTERNATIVES + 1)):
        raise argparse.ArgumentTypeError(f"should be a whole number from 1 to {MOST_ALTERNATIVES}, not {text!r}")
    return int(text)


def joined(argv: Sequence[str]) -> list[str]:
    """Values that begin with a minus are tied to their option; argparse would take `-z` for an option of its own.

    `--slicer` alone is tied to nothing: argparse would take the folder behind it for its path.
    """
    valued = {option for option, _, _ in (*_OPTIONS, *_REPEATED, *_SHAPES)}
    arguments, left = list[str](), iter(argv)
    for argument in left:
        value = next(left, None) if argument in valued else "" if argument == _SLICER else None
        arguments.append(argument if value is None else f"{argument}={value}")
    return arguments


def option_names() -> tuple[str, ...]:
    """The options that have a value, as Python names."""
    return tuple(option[2:].replace("-", "_") for option, _, _ in (*_OPTIONS, *_REPEATED, *_SHAPES))

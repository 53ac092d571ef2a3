"""argv becomes calls of the pipeline becomes an exit status; nothing else in foldfab prints or exits.

0 fine   1 cannot be folded, or a check fails   2 bad input   70 a bug   130 interrupted   141 nobody listens
"""

from __future__ import annotations

import argparse
import io
import os
import sys
import time
import traceback
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from foldfab.recipe.model import Recipe

MOST_ALTERNATIVES = 20
USAGE, BUG, INTERRUPTED, UNHEARD = 2, 70, 130, 141

_OPTIONS: tuple[tuple[str, str, str], ...] = (
    ("--direction", "D", 'folding direction: an axis such as -z, a vector such as 0,0,-1, or "auto"'),
    ("--posture", "P", "print it open or folded"),
    ("--printer", "NAME", "a known printer such as prusa-mk4, or a build volume such as 200x200x180"),
    ("--scale", "S", 'print size over true size: "fit", a number, or a ratio such as 1:5'),
    ("--clearance", "MM", "gap that a hinge is printed with, 0.15 to 1"),
    ("--thickness", "MM", "thickness of plates and panels, 2 to 20"),
    ("--base-thickness", "MM", "thickness of base plates, where it is another"),
    ("--alpha", "A", "weight of inserted hinges (1) against shrinking (0)"),
    ("--max-hinges", "N", "most hinges that may be inserted in one patch, 1 to 9"),
    ("--shrink-steps", "N", "how many pieces a patch is cut into for shrinking, 1 to 20"),
    ("--ordering", "O", "greedy, as in the paper, or optimal: modifications and order chosen in one shot"),
    ("--collisions", "C", "swept: shapes that meet in time; or regions: the paper's own test"),
    ("--time-limit", "SECONDS", "of work on an ordinary machine, up to 3600"),
)
_SWITCHES = ("slanting", "stay_in_box", "symmetry", "own_thickness", "split_shells")
_SHAPES = (
    ("--units", "U", "of a file of shapes: mm, cm, m or in; what it states, or a guess, where missing"),
    ("--up", "AXIS", "that points up in a file of shapes: x, y or z; its format's where missing"),
    ("--smallest", "MM", "bodies no longer than this are hardware, left out (2 %% of the furniture's longest side)"),
)
_SLICER = "--slicer"
_REPEATED = (("--rigid", "NAME", "a part that must not get a hinge in its middle; may be given again for others"),)


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command and return its exit status."""
    _show_any_letter(sys.stdout)
    try:
        status = _guarded(sys.argv[1:] if argv is None else argv)
        sys.stdout.flush()
        return status
    except BrokenPipeError:
        # What is still in the buffer would fail again when Python closes the stream.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return UNHEARD


def _guarded(argv: Sequence[str]) -> int:
    """The command's status, with every exception turned into one line on stderr."""
    from foldfab.errors import FoldfabError

    try:
        arguments = _parser().parse_args(_joined(argv))
        command: Callable[[argparse.Namespace], int] = arguments.command
        return command(arguments)
    except SystemExit as leave:
        return leave.code if isinstance(leave.code, int) else 0
    except FoldfabError as error:
        advice = f"\n  it would fold {', or '.join(error.advice)}" if error.advice else ""
        return _complain(f"{error}{advice}", error.exit_status)
    except KeyboardInterrupt:
        return _complain("interrupted", INTERRUPTED)
    except BrokenPipeError:
        raise
    except OSError as error:
        where = f"{error.filename}: " if error.filename else ""
        return _complain(f"{where}{error.strerror or error}; is there room, and may you write there?", USAGE)
    except Exception as error:
        return _bug(error)


def _print(arguments: argparse.Namespace) -> int:
    progress = _Progress(arguments.quiet)
    recipe = _load(arguments, progress)
    from foldfab import pipeline
    from foldfab.report import summary

    if arguments.step:
        progress("loading build123d")
        pipeline.require_cad()
    progress("looking for the cheapest fold")
    solution = _advised(recipe, progress, lambda: pipeline.foldabilize(recipe))
    progress("building the solids")
    assembly = pipeline.fabricate(solution, progress=progress)
    fatal = [finding.text for finding in assembly.findings if finding.is_fatal]
    if fatal:
        return _complain("this would not work:\n  " + "\n  ".join(fatal), 1)
    progress("writing")
    folder = Path(arguments.output) / recipe.name
    pipeline.write(assembly, folder, step=arguments.step)
    progress.done()
    if not arguments.quiet:
        print(summary(assembly, folder, pipeline.printable(folder)))
    return 0


def _fold(arguments: argparse.Namespace) -> int:
    progress = _Progress(arguments.quiet or arguments.json)
    recipe = _load(arguments, progress)
    from foldfab import pipeline, report
    from foldfab.errors import FoldfabError

    progress("looking for the cheapest fold")
    pipeline.prepare()
    count = arguments.alternatives
    start = time.perf_counter()
    try:
        solutions = _advised(
            recipe, progress, lambda: pipeline.alternatives(recipe, count) if count else (pipeline.foldabilize(recipe),)
        )
    except FoldfabError as error:
        if arguments.json and error.exit_status == 1:
            _print_json(report.refused_facts(str(error), error.advice))
            return 1
        raise
    milliseconds = 1000 * (time.perf_counter() - start)
    progress("trying it out")
    verdicts = [pipeline.examine(solution) for solution in solutions] if arguments.verify else []
    progress.done()
    if arguments.json:
        ranked = report.alternatives_facts(solutions, milliseconds) if count else None
        facts = ranked or report.fold_facts(solutions[0], milliseconds)
        _print_json(facts | (report.verdict_facts(*verdicts) if verdicts else {}))
    else:
        told = (
            report.alternatives_table(solutions, milliseconds)
            if count
            else report.fold_table(solutions[0], milliseconds)
        )
        print("\n\n".join([told, *map(report.judgement, verdicts)]))
    return 1 if any(verdict.violations for verdict in verdicts) else 0


def _advised(recipe: Recipe, progress: _Progress, solve: Callable[[], Any]) -> Any:
    """What `solve` gives; where it refuses, its error with what would help."""
    from foldfab.errors import FoldfabError

    try:
        return solve()
    except FoldfabError as error:
        if error.exit_status == 1:
            progress("looking for what would help")
            from foldfab.advice import what_would_help

            error.advice = what_would_help(recipe)
            progress.done()
        raise


def _recipe(arguments: argparse.Namespace) -> int:
    from foldfab.recipe.write import as_text

    sys.stdout.write(as_text(_load(arguments, _Progress(arguments.quiet))))
    return 0


def _check(arguments: argparse.Namespace) -> int:
    from foldfab import pipeline

    progress = _Progress(arguments.json)
    progress("checking" if arguments.slicer is None else "checking and slicing")
    found = pipeline.check(Path(arguments.folder), slicer=arguments.slicer)
    progress.done()
    if arguments.json:
        checks = [{"code": row.code, "ok": row.ok, "text": row.text} | row.facts for row in found.rows]
        _print_json({"status": "ok" if found.ok else "failed", "folder": arguments.folder, "checks": checks})
    else:
        for row in found.rows:
            print(f"{'ok  ' if row.ok else 'FAIL'}  {row.code:<10}  {row.text}")
    return 0 if found.ok else 1


def _recipes(arguments: argparse.Namespace) -> int:
    from foldfab import pipeline

    shipped = [pipeline.load(str(path)) for path in pipeline.shipped()]
    width = max((len(recipe.name) for recipe in shipped), default=0)
    for recipe in shipped:
        print(f"{recipe.name:<{width}}  {recipe.about}")
    return 0


def _compose(arguments: argparse.Namespace) -> int:
    from foldfab import pipeline

    recipe = pipeline.compose(arguments.kind, arguments.grid)
    file = Path(arguments.output or f"{recipe.name}.json")
    pipeline.save(recipe, file)
    print(f"{file}: {len(recipe.parts)} parts")
    return 0


def _load(arguments: argparse.Namespace, progress: _Progress) -> Recipe:
    progress("reading")
    from foldfab import pipeline

    overrides: dict[str, Any] = {name: getattr(arguments, name) for name in (*_option_names(), *_SWITCHES)}
    recipe = pipeline.load(arguments.recipe, **{key: value for key, value in overrides.items() if value is not None})
    progress.done()
    for note in () if arguments.quiet else recipe.notes:
        print(f"note: {note}", file=sys.stderr)
    return recipe


_CLEAR = "\r\033[K"
"""Back to the start of the line, and wipe it."""


class _Progress:
    """One line on stderr that says what is being done; silent off a terminal."""

    def __init__(self, is_quiet: bool) -> None:
        self.is_shown = not is_quiet and sys.stderr.isatty()

    def __call__(self, text: str) -> None:
        if self.is_shown:
            print(f"{_CLEAR}{text} …", end="", file=sys.stderr, flush=True)

    def done(self) -> None:
        """Clear the line."""
        if self.is_shown:
            print(_CLEAR, end="", file=sys.stderr, flush=True)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="foldfab", description="Furniture becomes a print that folds flat.", allow_abbrev=False
    )
    parser.add_argument("--version", action=_Version, nargs=0, help="show the version and exit")
    commands = parser.add_subparsers(title="commands", metavar="COMMAND", required=True)
    making = _command(commands, "print", _print, "fold a recipe's furniture and write a folder that prints")
    making.add_argument("-o", "--output", metavar="DIR", default="prints", help="where its folder goes (prints)")
    making.add_argument("--step", action="store_true", help="write a STEP file for CAD too, by build123d")
    folding = _command(commands, "fold", _fold, "only say what would be changed, in which order, at which cost")
    folding.add_argument("--json", action="store_true", help="print the facts as JSON")
    how_many = f"show the best K folds, 1 to {MOST_ALTERNATIVES}, and how they differ"
    folding.add_argument("--alternatives", metavar="K", type=_how_many, help=how_many)
    folding.add_argument(
        "--verify", action="store_true", help="try the fold out at every moment, apart from the search"
    )
    understanding = _command(commands, "recipe", _recipe, "write the recipe that a file is understood as")
    quieter = ((making, "show no progress and no summary"), (folding, "show no progress"), (understanding, "no notes"))
    for command, quiet in quieter:
        what = "a recipe (.json) or its name, a STEP, GLB, glTF, OBJ, 3MF or STL file, or a folder of STL files"
        command.add_argument("recipe", metavar="FILE", help=what)
        command.add_argument("-q", "--quiet", action="store_true", help=quiet)
        _add_options(command)
    checking = _command(commands, "check", _check, "inspect a print folder from its files alone")
    checking.add_argument("folder", metavar="FOLDER", help="a folder that `foldfab print` wrote")
    checking.add_argument("--json", action="store_true", help="print the facts as JSON")
    slicing = "slice it with PrusaSlicer too: time, filament, support, repairs, outlines at hinges"
    checking.add_argument(_SLICER, metavar="=PATH", nargs="?", const="", help=slicing)
    _command(commands, "recipes", _recipes, "list the recipes that foldfab ships")
    composing = _command(
        commands, "compose", _compose, "arrange furniture in a grid, as a recipe to measure foldfab by"
    )
    composing.add_argument("kind", metavar="KIND", help="bench, building, hexagon or shelf")
    composing.add_argument("grid", metavar="GRID", help="columns x rows, such as 4x4; at most 32x32")
    composing.add_argument("-o", "--output", metavar="FILE", help="where the recipe goes (KIND-GRID.json, here)")
    return parser


def _command(
    commands: argparse._SubParsersAction[argparse.ArgumentParser],
    name: str,
    run: Callable[[argparse.Namespace], int],
    text: str,
) -> argparse.ArgumentParser:
    parser = commands.add_parser(name, help=text, description=text, allow_abbrev=False)
    parser.set_defaults(command=run)
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
    group.add_argument("--symmetry", action="store_true", default=None, help="treat mirrored parts alike")
    group.add_argument("--own-thickness", action="store_true", default=None, help="parts as thick as they are, or more")


def _how_many(text: str) -> int:
    if text not in map(str, range(1, MOST_ALTERNATIVES + 1)):
        raise argparse.ArgumentTypeError(f"should be a whole number from 1 to {MOST_ALTERNATIVES}, not {text!r}")
    return int(text)


class _Version(argparse.Action):
    """Looked up only when asked for: importlib.metadata is slow to import."""

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> None:
        from importlib.metadata import PackageNotFoundError, version

        try:
            print(f"foldfab {version('foldfab')}")
        except PackageNotFoundError:
            print("foldfab 0.0.0 (not installed)")
        parser.exit()


def _joined(argv: Sequence[str]) -> list[str]:
    """Values that begin with a minus are tied to their option; argparse would take `-z` for an option of its own.

    `--slicer` alone is tied to nothing: argparse would take the folder behind it for its path.
    """
    valued = {option for option, _, _ in (*_OPTIONS, *_REPEATED, *_SHAPES)}
    arguments, left = list[str](), iter(argv)
    for argument in left:
        value = next(left, None) if argument in valued else "" if argument == _SLICER else None
        arguments.append(argument if value is None else f"{argument}={value}")
    return arguments


def _option_names() -> tuple[str, ...]:
    return tuple(option[2:].replace("-", "_") for option, _, _ in (*_OPTIONS, *_REPEATED, *_SHAPES))


def _print_json(facts: dict[str, Any]) -> None:
    import json

    print(json.dumps(facts, indent=1, ensure_ascii=False, allow_nan=False))


def _complain(text: str, status: int) -> int:
    print(f"{_CLEAR if sys.stderr.isatty() else ''}foldfab: {text}", file=sys.stderr)
    return status


def _bug(error: Exception) -> int:
    if os.environ.get("FOLDFAB_DEBUG") == "1":
        traceback.print_exception(error, file=sys.stderr)
    what = " ".join(f"{type(error).__name__}: {error}".split())[:200]
    advice = "please report it with the recipe; FOLDFAB_DEBUG=1 shows the traceback"
    return _complain(f"this is a bug in foldfab ({what}); {advice}", BUG)


def _show_any_letter(stream: object) -> None:
    """A terminal that cannot show × or α gets an escape instead of a crash."""
    if isinstance(stream, io.TextIOWrapper):
        stream.reconfigure(errors="backslashreplace")


if __name__ == "__main__":
    sys.exit(main())

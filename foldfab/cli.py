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

from foldfab.arguments import SWITCHES, Run, joined, option_names, parser

if TYPE_CHECKING:
    from foldfab.recipe.model import Recipe

USAGE, BUG, INTERRUPTED, UNHEARD = 2, 70, 130, 141


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
        arguments = parser(_COMMANDS, _Version).parse_args(joined(argv))
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
    recipe = _settled(recipe, progress)
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

    recipe = _settled(recipe, progress)
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


def _directions(arguments: argparse.Namespace) -> int:
    progress = _Progress(arguments.quiet or arguments.json)
    recipe = _load(arguments, progress)
    from foldfab import pipeline, survey

    rows = pipeline.directions(recipe, progress)
    folds = rows[0].best.solution is not None
    if folds:
        progress("drawing")
        folder = survey.write(rows, recipe.name, Path(arguments.output) / recipe.name)
    progress.done()
    if arguments.json:
        _print_json(survey.facts(rows, recipe.name))
    else:
        print(survey.table(rows, recipe.name))
        if folds:
            print(f"\nPictures: {folder / survey.picture_name('RANK')}")
    return 0 if folds else 1


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


def _postures(arguments: argparse.Namespace) -> int:
    progress = _Progress(arguments.quiet)
    recipe = _load(arguments, progress)
    from foldfab import postures
    from foldfab.report import postures_table

    rows = postures.compared(recipe, progress)
    progress.done()
    print(postures_table(rows))
    return 0


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


def _coupon(arguments: argparse.Namespace) -> int:
    from foldfab import pipeline

    folder = pipeline.coupon(
        arguments.output, arguments.printer, thickness=arguments.thickness, posture=arguments.posture
    )
    print(f"Written to {folder}")
    print("Print coupon.3mf, move every flap, and keep the least number that moves freely:")
    print(f"  foldfab calibrate --printer {arguments.printer} NUMBER")
    return 0


def _calibrate(arguments: argparse.Namespace) -> int:
    from foldfab import pipeline

    file = pipeline.calibrate(arguments.printer, arguments.clearance)
    print(f"{arguments.printer} prints hinges with {arguments.clearance:g} mm from now on ({file})")
    return 0


def _settled(recipe: Recipe, progress: _Progress) -> Recipe:
    if recipe.print.posture != "auto":
        return recipe
    from foldfab import postures

    return postures.settled(recipe, progress)


def _load(arguments: argparse.Namespace, progress: _Progress) -> Recipe:
    progress("reading")
    from foldfab import pipeline

    overrides: dict[str, Any] = {name: getattr(arguments, name) for name in (*option_names(), *SWITCHES)}
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


class _Version(argparse.Action):
    """Looked up only when asked for: importlib.metadata is slow to import."""

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> None:
        from importlib.metadata import PackageNotFoundError, version

        try:
            print(f"foldfab {version('foldfab')}")
        except PackageNotFoundError:
            print("foldfab 0.0.0 (not installed)")
        parser.exit()


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


_COMMANDS: dict[str, Run] = {
    "print": _print,
    "fold": _fold,
    "recipe": _recipe,
    "directions": _directions,
    "postures": _postures,
    "check": _check,
    "recipes": _recipes,
    "compose": _compose,
    "coupon": _coupon,
    "calibrate": _calibrate,
}


if __name__ == "__main__":
    sys.exit(main())

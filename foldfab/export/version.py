"""Which foldfab wrote a file."""

from __future__ import annotations

from importlib.metadata import PackageNotFoundError, version


def foldfab_version() -> str:
    """The installed version, `0.0.0` where foldfab runs from a bare source tree."""
    try:
        return version("foldfab")
    except PackageNotFoundError:
        return "0.0.0"

"""Two files of the same solids become one: uses are counted from 1, colours stand in the order of parts."""

from __future__ import annotations

import pytest

from foldfab.export.step_order import canonical

HEAD = "ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\n#1 = PART('a');\n#2 = PART('b');\n"
TAIL = "ENDSEC;\nEND-ISO-10303-21;\n"
STYLES = "MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION_REPRESENTATION"


def use(number: int, name: str) -> str:
    return f"#3 = NEXT_ASSEMBLY_USAGE_OCCURRENCE('{number}','{name}','',#1,#2,$);\n"


def styles(first: int, part: int, colour: int, *, has_colour: bool) -> str:
    own = f"#{colour} = COLOUR_RGB('',1.,0.,0.);\n" if has_colour else ""
    return (
        f"#{first} = {STYLES}('',(\n    #{first + 1}),#{part});\n"
        f"#{first + 1} = STYLED_ITEM('color',(#{first + 2}),#{part});\n"
        f"#{first + 2} = STYLE(#{colour},\n  .BOTH.);\n{own}"
    )


ONE = HEAD + use(1, "a") + styles(10, 1, 13, has_colour=True) + styles(14, 2, 13, has_colour=False) + TAIL
OTHER = HEAD + use(7, "a") + styles(10, 2, 13, has_colour=True) + styles(14, 1, 13, has_colour=False) + TAIL


def test_files_of_two_runs_are_the_same() -> None:
    assert ONE != OTHER
    assert canonical(ONE.encode()) == canonical(OTHER.encode())


def test_nothing_is_lost_and_nothing_else_changes() -> None:
    text = canonical(OTHER.encode()).decode()
    assert text.startswith(HEAD + use(1, "a"))
    assert text.endswith(TAIL)
    assert (
        f"#10 = {STYLES}('',(#11),#1);\n#11 = STYLED_ITEM('color',(#12),#1);\n#12 = STYLE(#13,.BOTH.);\n#13 = CO"
        in text
    )
    assert f"#14 = {STYLES}('',(#15),#2);\n#15 = STYLED_ITEM('color',(#16),#2);\n#16 = STYLE(#13,.BOTH.);\n" in text
    assert canonical(text.encode()) == text.encode()


def test_other_files_are_other_files() -> None:
    assert canonical(ONE.replace("1.,0.,0.", "0.,1.,0.").encode()) != canonical(ONE.encode())
    assert canonical(ONE.replace("PART('a')", "PART('c')").encode()) != canonical(ONE.encode())


def test_a_file_without_colours() -> None:
    assert canonical((HEAD + use(4, "a") + TAIL).encode()) == (HEAD + use(1, "a") + TAIL).encode()


def test_lines_break_where_they_always_do() -> None:
    broken = use(100, "a").replace(",$);", ",$\n  );")
    assert canonical((HEAD + broken + TAIL).encode()) == (HEAD + use(1, "a") + TAIL).encode()


@pytest.mark.parametrize(
    ("name", "escaped"),
    [
        ("é椅", r"'\X2\00E96905\X0\',"),
        ("é椅".encode().decode("latin-1"), r"'\X2\00E96905\X0\',"),
        ("a🪑b", r"'a\X4\0001FA91\X0\b',"),
    ],
    ids=["as they are", "as bytes", "beyond the first plane"],
)
def test_letters_of_any_language_are_escaped(name: str, escaped: str) -> None:
    assert escaped in canonical((HEAD + use(1, name) + TAIL).encode()).decode("ascii")

"""Nothing of the language is used before a lesson has told of it."""

import re

from logical_robots_tui.language.reference import REFERENCE
from tests.levels.playing import LEVELS, load_level, program_text, solution_of

NAMES = {entry.name for entry in REFERENCE if re.fullmatch("[A-Z][A-Za-z0-9]*", entry.name)}
MARKS = {
    "->": "->",
    "~": "~",
    ":=": ":=",
    "distinct": r"\bdistinct\b",
    "in": r"\bin\b",
    "if": r"\bif\b",
    "is null": r"\bis (not )?null\b",
    "==": "==",
    "!=": "!=",
    "&&": "&&",
    "||": r"\|\|",
    "+=": r"\+=",
    "++": r"\+\+",
    "@": r"@[A-Z]",
    "Memory": r"\bMemory\(",
}


def code_in(text: str) -> str:
    """The code of a lesson or a hint: its blocks but those of SQL, and what is in backticks."""
    blocks = re.findall(r"^```\n(.*?)^```", text, re.DOTALL | re.MULTILINE)
    return "\n".join([*blocks, *re.findall(r"`([^`\n]+)`", text)])


def used_in(code: str) -> set[str]:
    """The functions, aggregates and marks that occur in code, but for its comments and texts."""
    bare = re.sub(r'#.*|"[^"\n]*"', "", code)
    called = {name for name in NAMES if re.search(rf"\b{name}(\(| ?\{{|=)", bare)}
    return called | {mark for mark, pattern in MARKS.items() if re.search(pattern, bare)}


def told_in(lesson: str) -> set[str]:
    code = code_in(lesson)
    named = {name for name in NAMES if re.search(rf"\b{name}\b", lesson)}
    return named | {mark for mark, pattern in MARKS.items() if re.search(pattern, code)}


def test_nothing_is_used_before_its_lesson() -> None:
    told = set[str]()
    for level in map(load_level, LEVELS):
        told |= told_in(level.lesson)
        parts = {
            "briefing": level.briefing,
            "starter": program_text(level.starter),
            "solution": program_text(solution_of(level.name)),
            "hints": code_in("\n".join(level.hints)),
            "questions": "\n".join(question.answer for question in level.questions),
        }
        early = {part: used_in(code) - told for part, code in parts.items()}
        assert not any(early.values()), (level.name, early)

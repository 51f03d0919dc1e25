"""Style sheets that are parsed once, however many dialogs and apps use them."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

from textual.css.model import RuleSet
from textual.css.stylesheet import Stylesheet


class SharedStylesheet(Stylesheet):
    """Style sheets of which a text is parsed once for each theme, for all apps of a process.

    Textual keeps what it has parsed in a style sheet, but makes another one for a new theme and for
    a dialog with styles of its own, and an app that is forked begins with none.
    """

    def __init__(self, *, variables: dict[str, str] | None = None) -> None:
        super().__init__(variables=variables)
        self._use(variables or {})

    def copy(self) -> SharedStylesheet:
        copied = SharedStylesheet(variables=self._theme)
        copied.source = self.source.copy()
        return copied

    def set_variables(self, variables: dict[str, str]) -> None:
        super().set_variables(variables)
        self._use(variables)

    def _use(self, variables: dict[str, str]) -> None:
        self._theme = variables.copy()
        self._parsed = _parsed_with(tuple(variables.items()))

    def reparse(self) -> None:
        self.parse()

    def _parse_rules(self, css: str, *place: Any, **options: Any) -> list[RuleSet]:
        key = css, place, *options.items()
        if key not in self._parsed:
            self._parsed[key] = super()._parse_rules(css, *place, **options)
        return self._parsed[key]


@lru_cache(maxsize=4)
def _parsed_with(_variables: tuple[tuple[str, str], ...]) -> dict[object, list[RuleSet]]:
    """Return the rules by their text and place with the variables of a theme, at first none."""
    return {}

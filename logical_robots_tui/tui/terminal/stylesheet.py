"""Style sheets that are parsed once, however many dialogs and apps use them."""

from __future__ import annotations

from typing import Any, ClassVar

from textual.cache import LRUCache
from textual.css.model import RuleSet
from textual.css.stylesheet import Stylesheet


class SharedStylesheet(Stylesheet):
    """Style sheets of which a text is parsed once for each theme, for all apps of a process.

    Textual keeps fewer texts than an app has, and parses all of them again for a dialog.
    """

    _parsed: ClassVar[LRUCache[object, list[RuleSet]]] = LRUCache(400)  # of three or four themes

    def __init__(self, *, variables: dict[str, str] | None = None) -> None:
        super().__init__(variables=variables)
        self._values = tuple((variables or {}).items())

    def copy(self) -> SharedStylesheet:
        copied = SharedStylesheet(variables=dict(self._values))
        copied.source = self.source.copy()
        return copied

    def set_variables(self, variables: dict[str, str]) -> None:
        super().set_variables(variables)
        self._values = tuple(variables.items())

    def reparse(self) -> None:
        self.parse()

    def _parse_rules(self, css: str, *place: Any, **options: Any) -> list[RuleSet]:
        key = self._values, css, place, *options.items()
        rules = self._parsed.get(key)
        if rules is None:
            rules = self._parsed[key] = super()._parse_rules(css, *place, **options)
        return rules

"""What a player has in an open game, put together for a screen or for lines of text."""

from __future__ import annotations

from typing import TYPE_CHECKING

from logical_robots_tui.game import level_key
from logical_robots_tui.player.drafts import Autosave, Drafts, UnsavedText, program_draft
from logical_robots_tui.player.learning import Learning
from logical_robots_tui.player.library import Library
from logical_robots_tui.player.recovery import Bookmark, Offering, OtherGames
from logical_robots_tui.player.session import Session

if TYPE_CHECKING:
    from collections.abc import Callable

    from logical_robots_tui.player.opening import Opening
    from logical_robots_tui.player.recorder import ProgressRecorder
    from logical_robots_tui.player.session_state import ProgramText, Ui


class Player:
    """The session, and who keeps what the player does in it.

    `with_keys` says in a text how the commands in braces are given.

    Attributes:
        first_text: What `program` begins with.
    """

    def __init__(
        self,
        opening: Opening,
        recorder: ProgressRecorder,
        ui: Ui,
        program: ProgramText,
        changed: Callable[[], None],
        with_keys: Callable[[str], str],
    ) -> None:
        self._opening, self._ui, self.recorder = opening, ui, recorder
        session = self.session = Session(
            opening.level, opening.sources, ui.spawn, changed, opening.clock
        )
        self.first_text = session.source.text if opening.text is None else opening.text
        drafts = self.drafts = Drafts(opening.data_dir / "drafts")
        autosave = self.autosave = Autosave(
            drafts,
            state=lambda: UnsavedText(session.source, program.text, level_key(session.level)),
            draft=program_draft,
            failed=ui.warn,
            what="What you type",
        )
        library = self.library = Library(
            session, ui, recorder, drafts, autosave, program, opening.data_dir
        )
        self.learning = Learning(session, ui, recorder, program, library.open_program, with_keys)
        self.bookmark = Bookmark(
            session, drafts, ui, library.open_level, library.open_program, library.look_at
        )

    def start(self) -> None:
        """Begin to record and to compile, once all listen to the session."""
        self.recorder.level_opened(self.session.opened)
        self.session.apply(self.first_text)

    def offerings(self, *others: Offering) -> list[Offering]:
        """Return what to offer from earlier sessions, in order."""
        games = self._opening.games
        first = [] if games is None else [OtherGames(games, self._ui)]
        return [*first, self.library, *others, self.bookmark]

    async def close(self) -> None:
        self.autosave.stop()
        self.drafts.close()
        await self.session.close()
        await self.recorder.close()

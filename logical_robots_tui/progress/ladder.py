"""Ladders: the arenas on a board, in which the programs that players hand in are ranked."""

from __future__ import annotations

import sqlite3
from collections.abc import Mapping, Sequence
from typing import NamedTuple

from logical_robots_tui.progress.board import Board, shown_name
from logical_robots_tui.progress.store import program_digest

HOUSE = "_sparring"
"""The sparring partner, who plays in each ladder; no player can have this name."""


class LadderRank(NamedTuple):
    """Whom a program beats: share of the points from 0 to 1 with its 95% interval, and strength.

    One with a problem has no rank.
    """

    rank: str = ""
    share: float = 0.0
    low: float = 0.0
    high: float = 0.0
    strength: float = 0.0
    problem: str = ""


class Challenger(NamedTuple):
    """A player in a ladder; `is_new` if the program handed in last has not been ranked yet."""

    player: str
    name: str | None
    is_me: bool
    is_new: bool
    result: LadderRank

    @property
    def label(self) -> str:
        return "sparring partner" if self.player == HOUSE else shown_name(self.name)

    @property
    def remark(self) -> str:
        """Why there is no rank, or that it is of an earlier program."""
        if self.result.problem:
            return self.result.problem
        if not self.result.rank:
            return "waits for its first match"
        return "a new program waits" if self.is_new else ""

    @property
    def cells(self) -> tuple[str, str, str, str]:
        """Rank, name, share and remark, for a table."""
        has_rank = self.result.rank and not self.result.problem
        share = f"{100 * self.result.share:.1f}%" if has_rank else ""
        return self.result.rank if has_rank else "-", self.label, share, self.remark


class Ladder:
    """The ladder of an arena on a board; its methods raise as those of the board."""

    def __init__(self, board: Board, arena: str) -> None:
        self._board, self.arena = board, arena

    def hand_in(self, text: str) -> None:
        """Let the player's program play, instead of what they handed in before."""
        board, program = self._board, program_digest(text)
        values = {"arena": self.arena, "player": board.player, "program": program}

        def write(connection: sqlite3.Connection) -> None:
            board.save_program(f"{program}.l", text)
            connection.execute(
                "INSERT INTO challenger (arena, player, program) VALUES (:arena, :player, :program)"
                "ON CONFLICT (arena, player) DO UPDATE SET program = excluded.program",
                values,
            )

        board.write(write)

    def challengers(self) -> list[Challenger]:
        """Return who plays, the best first and then those who wait for their first match."""
        rows = self._board.rows(
            "SELECT player, name, player = :player, played IS NOT program, rank, share, low, high, "
            "strength, problem FROM challenger LEFT JOIN player USING (player) "
            "WHERE arena = :arena ORDER BY played IS NULL, share DESC, player",
            arena=self.arena,
        )
        return [
            Challenger(player, name, bool(is_me), bool(is_new), LadderRank(*numbers))
            for player, name, is_me, is_new, *numbers in rows
        ]

    def programs(self) -> dict[str, str]:
        """Return the digests of what was handed in, by player."""
        query = "SELECT player, program FROM challenger WHERE arena = :arena ORDER BY player"
        return dict(self._board.rows(query, arena=self.arena))

    def rank(self, programs: Mapping[str, str], ranks: Mapping[str, LadderRank]) -> None:
        """Record ranks by player, for the programs with these digests."""

        def write(connection: sqlite3.Connection) -> None:
            for player, result in ranks.items():
                values = {"arena": self.arena, "player": player, "played": programs[player]}
                connection.execute(
                    "INSERT INTO challenger (arena, player, program) "
                    "SELECT :arena, :player, :played WHERE :player = :house "
                    "ON CONFLICT (arena, player) DO UPDATE SET program = excluded.program",
                    {**values, "house": HOUSE},
                )
                connection.execute(
                    "UPDATE challenger SET played = :played, rank = :rank, share = :share, "
                    "low = :low, high = :high, strength = :strength, problem = :problem "
                    "WHERE arena = :arena AND player = :player",
                    values | result._asdict(),
                )

        self._board.write(write)

    def matches(self) -> dict[tuple[str, str], str]:
        """Return what is there to watch: by upper and lower player the digests of programs."""
        query = "SELECT upper, lower, programs FROM match WHERE arena = :arena"
        rows = self._board.rows(query, arena=self.arena)
        return {(upper, lower): programs for upper, lower, programs in rows}

    def keep_matches(
        self, pairs: Sequence[tuple[str, str]], replays: Mapping[tuple[str, str], tuple[str, bytes]]
    ) -> None:
        """Keep the matches of these pairs; `replays` are digests and contents of new ones."""

        def write(connection: sqlite3.Connection) -> None:
            query = "SELECT upper, lower FROM match WHERE arena = ?"
            for upper, lower in {*connection.execute(query, (self.arena,))} - {*pairs}:
                connection.execute(
                    "DELETE FROM match WHERE arena = ? AND upper = ? AND lower = ?",
                    (self.arena, upper, lower),
                )
            for (upper, lower), (programs, content) in replays.items():
                connection.execute(
                    "INSERT OR REPLACE INTO match VALUES (?, ?, ?, ?, ?)",
                    (self.arena, upper, lower, programs, content),
                )

        self._board.write(write)

    def match(self, player: str, opponent: str) -> bytes | None:
        """Return the replay of a match of two players, or None."""
        rows = self._board.rows(
            "SELECT replay FROM match WHERE arena = :arena AND :one <> :two "
            "AND upper IN (:one, :two) AND lower IN (:one, :two)",
            arena=self.arena,
            one=player,
            two=opponent,
        )
        return rows[0][0] if rows else None

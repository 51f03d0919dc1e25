"""Whose a submission is: students of a roster and names of submissions."""

from __future__ import annotations

import re
from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

from logical_robots_tui.game.source import SUFFIX
from logical_robots_tui.lab.platforms.archives import stem_of
from logical_robots_tui.lab.platforms.names import plain, words_of
from logical_robots_tui.lab.platforms.tables import StudentRow

_MOST_WORDS = 10  # of a name of people, which may be in any order
_REMOVED = "[<>:\"/\\\\|?*=&'\u2019`]"  # what platforms remove from names
_SHORTEST = 3  # letters and digits that identify somebody within a longer name


class _PersonalNames(NamedTuple):
    """What one person can claim of a submission: its names, without the group's other people."""

    submission: str
    names: frozenset[str]


class RosterMatches(NamedTuple):
    """Submissions by the ids of students, and the students whom the others fit equally well."""

    submissions: dict[str, list[str]]
    ties: dict[str, list[str]]


def match_roster(
    rows: Sequence[StudentRow], submissions: Mapping[str, Sequence[frozenset[str]]]
) -> RosterMatches:
    """Return whose submissions are, by their names and ids for each person who handed them in.

    What a row names exactly is found first, for several rows if they name the same one; then what
    is the same but for case and accents, then names of people in any order of their words, then
    ids and names anywhere in a submission's name. What fits two students equally well is nobody's.
    Members of a group share what is named after it, or what one of them handed in.
    """
    matches = _of_groups(rows, submissions)
    group_names = {name for names in matches.values() for name in names}
    shares = {
        _PersonalNames(name, texts)
        for name, people in submissions.items()
        for texts in people
        if name not in group_names
    }
    ties: dict[str, list[str]] = {}
    for step in range(4):
        open_rows = [row for row in rows if row.id not in matches]
        if step < 3:
            keys: dict[str, set[_PersonalNames]] = defaultdict(set)
            for share in shares:
                for name in share.names:
                    keys[plain(name) if step else name].add(share)
            claims = {
                row.id: {share for key in _keys_of(row)[step] for share in keys.get(key, ())}
                for row in open_rows
            }
        else:
            claims = _claims_by_words(open_rows, shares)
        counts = Counter(share for candidates in claims.values() for share in candidates)
        for student, candidates in claims.items():
            matched = {share for share in candidates if counts[share] == 1 or not step}
            if matched:
                matches[student] = sorted({share.submission for share in matched})
                shares -= matched
            for share in candidates - matched:
                ties.setdefault(share.submission, []).append(student)
    _share_in_groups(rows, matches)
    for name in {name for names in matches.values() for name in names} & ties.keys():
        del ties[name]
    return RosterMatches(matches, {name: list(dict.fromkeys(ties[name])) for name in sorted(ties)})


def _of_groups(
    rows: Sequence[StudentRow], submissions: Mapping[str, Sequence[frozenset[str]]]
) -> dict[str, list[str]]:
    """Return submissions named after groups, by the ids of their members."""
    members: dict[str, list[str]] = defaultdict(list)
    for row in rows:
        if plain(row.group):
            members[plain(row.group)].append(row.id)
    matches: dict[str, list[str]] = defaultdict(list)
    for name, people in submissions.items() if members else ():
        for group in {plain(text) for texts in people for text in texts} & members.keys():
            for student in members[group]:
                matches[student].append(name)
    return matches


def _share_in_groups(rows: Sequence[StudentRow], matches: dict[str, list[str]]) -> None:
    """Give members of a group what the only other member with a submission handed in."""
    by_group: dict[str, set[tuple[str, ...]]] = defaultdict(set)
    for row in rows:
        if row.group and row.id in matches:
            by_group[row.group].add(tuple(matches[row.id]))
    for row in rows:
        if row.id not in matches and len(by_group.get(row.group, ())) == 1:
            matches[row.id] = list(*by_group[row.group])


def _keys_of(row: StudentRow) -> tuple[list[str], list[str], list[str]]:
    """Return what a row names exactly, but for case and accents, and in other orders of words."""
    exact_name = row.submission or row.id
    # Moodle's identifiers end with the number in the names of its exports, in any language.
    numbers = re.findall(r"^[^\W\d]{5}\D*(\d+)$", row.id)
    ids = [stem_of(row.submission, SUFFIX), row.id, *row.aliases, *numbers]
    words = words_of(row.name)
    orders = range(len(words) if len(words) <= _MOST_WORDS else 1)
    return (
        [exact_name, stem_of(exact_name, SUFFIX)],
        [key for key in map(plain, ids) if key],
        ["".join(words[n:] + words[:n]) for n in orders],
    )


def _claims_by_words(
    rows: Iterable[StudentRow], shares: Iterable[_PersonalNames]
) -> dict[str, set[_PersonalNames]]:
    """Return shares by the students whose id or name is anywhere in their names."""
    by_word: dict[str, list[tuple[str, tuple[str, ...], bool]]] = defaultdict(list)
    for row in rows:
        entries = {(words_of(text), True) for text in (row.id, *row.aliases)}
        for text in (row.name, re.sub(_REMOVED, "", row.name)):
            entries.add((tuple(word for word in words_of(text) if len(word) > 1), False))
        for words, is_id in entries:
            if len("".join(words)) >= _SHORTEST:
                by_word[words[0]].append((row.id, words, is_id))
    claims: dict[str, set[_PersonalNames]] = defaultdict(set)
    for share in shares:
        fits: dict[str, set[str]] = defaultdict(set)
        for words in map(words_of, share.names):
            for word in {*words} & by_word.keys():
                for student, own_words, is_id in by_word[word]:
                    text, line = " ".join(own_words), " ".join(words)
                    if f" {text} " in f" {line} " if is_id else {*words} >= {*own_words}:
                        fits[student].update(own_words)
        for student, fit in fits.items():
            if not any(fit < words for words in fits.values()):
                claims[student].add(share)
    return claims

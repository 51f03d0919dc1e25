"""What is kept of a player's work, and what comes back."""

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from logical_robots_tui.progress import MOST_VERSIONS, NEW, Bests, Measures, Progress

MEASURED = Measures(ticks=100, size=3, distance=250.5, wins=18, starts=20)


@pytest.fixture
def file(tmp_path: Path) -> Path:
    return tmp_path / "data" / "progress.sqlite"


@pytest.fixture
def progress(file: Path) -> Progress:
    return Progress(file, pytest.fail)


def texts(progress: Progress, level: str) -> list[str]:
    return [version.text for version in progress.versions(level)]


def test_looking_makes_no_file(progress: Progress, file: Path) -> None:
    assert progress.record("one") == NEW
    assert progress.versions("one") == []
    assert progress.newest("one") is None
    assert progress.fact("tour") is None
    assert not progress.holds("text")
    assert not file.parent.exists()


def test_a_level_is_new_then_in_work_then_won_and_its_hints_stay(progress: Progress) -> None:
    progress.reveal("one", 3)
    progress.reveal("one", 1)
    assert (progress.record("one").state, progress.record("one").hints) == ("new", 3)
    progress.begin("one")
    assert progress.record("one").state == "started"
    progress.win("one", "text", MEASURED)
    assert progress.record("one").state == "won"
    assert progress.record("two") == NEW


def test_everything_is_there_in_the_next_session(file: Path, progress: Progress) -> None:
    progress.win("one", "text", MEASURED)
    progress.reveal("one", 2)
    progress.keep("one", "later")
    progress.set_fact("tour", "seen")
    progress.answer("one", "Who?", "Robot")
    progress.answer("one", "How far?", "sensor.forward_distance")
    progress.answer("one", "Who?", "Here(1);")
    progress.answer("two", "Who?", "\ud800")
    progress.close()
    second = Progress(file, pytest.fail)
    record = second.record("one")
    assert (record.state, record.hints, record.versions) == ("won", 2, 2)
    assert record.bests == Bests(100, 3, 250.5, 18, 20)
    assert texts(second, "one") == ["later", "text"]
    assert [version.won for version in second.versions("one")] == [False, True]
    assert second.versions("one")[1].measures == MEASURED
    assert second.fact("tour") == "seen"
    answers = (("How far?", "sensor.forward_distance"), ("Who?", "Here(1);"))
    assert record.answers == answers, "the last to each question"
    assert second.record("two") == NEW._replace(answers=(("Who?", "?"),))


def test_each_measure_has_a_best_of_its_own_and_later_ones_join(progress: Progress) -> None:
    progress.win("one", "fast", Measures(ticks=10, size=9, distance=90.0))
    progress.win("one", "short", Measures(ticks=99, size=1, distance=95.0, wins=3, starts=20))
    progress.win("one", "straight", Measures(ticks=50, size=5, distance=20.0, wins=2, starts=3))
    assert progress.record("one").bests == Bests(10, 1, 20.0, 2, 3)
    progress.win("two", "text")
    assert progress.record("two").state == "won"
    assert progress.record("two").bests == Bests()
    progress.win("two", "text", MEASURED)
    progress.win("two", "text", Measures(ticks=100, size=3, distance=250.5))
    assert progress.versions("two")[0].measures == MEASURED


def test_the_same_text_is_kept_once_and_is_the_newest_again(progress: Progress) -> None:
    for text in ("a", "b", "a"):
        progress.keep("one", text)
    assert texts(progress, "one") == ["a", "b"]
    assert progress.newest("one") == "a"
    assert texts(progress, "two") == []
    assert progress.holds("b")
    assert not progress.holds("c")


def test_old_versions_go_but_not_the_best(
    progress: Progress, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("logical_robots_tui.progress.progress.MOST_VERSIONS", 3)
    progress.win("one", "fast", Measures(1, 9, 9.0))
    progress.win("one", "short", Measures(9, 1, 9.0))
    progress.win("one", "straight", Measures(9, 9, 1.0))
    progress.win("one", "robust", Measures(9, 9, 9.0, 20, 20))
    progress.win("one", "plain", Measures(9, 9, 9.0, 19, 20))
    progress.win("one", "quiet", Measures(9, 9, 9.0, goals=("never blocked",)))
    progress.keep("two", "elsewhere")
    for number in range(10):
        progress.keep("one", f"try {number}")
    best = ["quiet", "robust", "straight", "short", "fast"]
    assert texts(progress, "one") == ["try 9", "try 8", "try 7", *best]
    assert progress.record("one").bests == Bests(1, 1, 1.0, 20, 20, ("never blocked",))
    assert texts(progress, "two") == ["elsewhere"]
    assert MOST_VERSIONS >= 50


def test_second_goals_are_those_of_all_victories_together(progress: Progress) -> None:
    progress.win("one", "quiet", MEASURED._replace(goals=("never blocked",)))
    progress.win("one", "both", MEASURED._replace(goals=("at most 90 symbols", "never blocked")))
    progress.win("one", "both", MEASURED._replace(goals=()))
    progress.win("one", "neither", MEASURED)
    assert progress.record("one").bests.goals == ("at most 90 symbols", "never blocked")
    assert progress.measures("one", "quiet") == MEASURED._replace(goals=("never blocked",))
    goals = [version.measures.goals for version in progress.versions("one") if version.measures]
    assert goals == [(), ("at most 90 symbols", "never blocked"), ("never blocked",)]
    assert progress.record("two").bests.goals == ()


@given(st.lists(st.tuples(st.sampled_from("ab"), st.text()), max_size=12))
def test_any_texts_come_back_in_the_order_of_their_last_use(uses: list[tuple[str, str]]) -> None:
    progress = Progress(None, pytest.fail)
    for level, text in uses:
        progress.keep(level, text)
    for level in "ab":
        mine = [text for at, text in uses if at == level]
        assert texts(progress, level) == list(dict.fromkeys(reversed(mine)))


WINS = st.none() | st.integers(0, 20)
NUMBERS = (st.integers(1, 20_000), st.integers(1, 100), st.floats(0, 1e6), WINS, st.just(20))
MEASURES = st.builds(Measures, *NUMBERS)


@given(st.lists(MEASURES, min_size=1, max_size=8))
def test_bests_are_the_least_and_the_most(victories: list[Measures]) -> None:
    progress = Progress(None, pytest.fail)
    for number, measures in enumerate(victories):
        progress.win("one", f"text {number}", measures)
    ticks, sizes, distances, wins = list(zip(*victories, strict=True))[:4]
    most = max((won for won in wins if won is not None), default=None)
    assert progress.record("one").bests[:4] == (min(ticks), min(sizes), min(distances), most)


def test_half_a_character_does_no_harm_not_even_in_the_path_of_a_level(progress: Progress) -> None:
    progress.keep("one", "a\ud800b")
    assert texts(progress, "one") == ["a?b"]
    assert progress.holds("a\ud800b")
    level = "/tmp/\udcdcbung/own.toml"
    progress.begin(level)
    progress.reveal(level, 1)
    progress.keep(level, "text")
    progress.win(level, "text", Measures(1, 2, 3.0, 4, 20))
    assert progress.record(level).hints == 1
    assert texts(progress, level) == [progress.newest(level)] == ["text"]
    assert progress.measures(level, "text") is not None

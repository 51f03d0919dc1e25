"""What the checks say about a program, in this process: what most programs are refused for."""

from logical_robots_tui.language import package_patches
from logical_robots_tui.language.adapter import parse
from logical_robots_tui.language.checks import check
from logical_robots_tui.language.definitions import Model
from logical_robots_tui.language.source_text import prepare
from logical_robots_tui.mind import Diagnostic
from logical_robots_tui.mind.compiling.dialect import runs

package_patches.install()  # as in the compile process


def problems(text: str) -> tuple[Diagnostic, ...]:
    parsed = parse(prepare(text))
    model = Model(parsed.statements, parsed.source, parsed.doubtful)
    return tuple(check(model, parsed.problems, runs).problems)

"""The drawing of the labyrinth: pure functions from a level and a frame to cells."""

from logical_robots_tui.tui.labyrinth.drawing.cells import DARK, LIGHT, Cells, Palette
from logical_robots_tui.tui.labyrinth.drawing.glyphs import Drawing, Look, legend
from logical_robots_tui.tui.labyrinth.drawing.picture import Picture
from logical_robots_tui.tui.labyrinth.drawing.viewport import Viewport

__all__ = ["DARK", "LIGHT", "Cells", "Drawing", "Look", "Palette", "Picture", "Viewport", "legend"]

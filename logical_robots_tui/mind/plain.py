"""Text that can be shown anywhere."""

__all__ = ["printable"]


def printable(text: str) -> str:
    """A text of the same length without control, bidirectional and other invisible characters."""
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() else "\N{REPLACEMENT CHARACTER}" for c in text)

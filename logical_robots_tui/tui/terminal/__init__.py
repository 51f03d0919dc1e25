"""The connection to the terminal, and everything that touches Textual's private parts."""

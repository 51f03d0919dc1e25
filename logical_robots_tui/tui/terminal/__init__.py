"""What goes over the wire to a terminal, and all that touches Textual's private parts."""

"""The program: editor, colours, errors."""

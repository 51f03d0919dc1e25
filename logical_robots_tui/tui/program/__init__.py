"""The program: editor, colours, mistakes."""

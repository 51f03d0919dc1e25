"""Mistakes in a program, found before it runs. In the compile process."""

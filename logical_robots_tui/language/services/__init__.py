"""What an editor asks of a program's text and cursor: words, help, tokens and changed lines."""

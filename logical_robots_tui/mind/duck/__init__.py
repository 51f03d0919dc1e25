"""DuckDB as another engine for crowds: the same thoughts, computed column by column."""

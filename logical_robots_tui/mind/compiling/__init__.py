"""From Logica text to SQL. Runs in the compile process only."""

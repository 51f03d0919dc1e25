"""The SQL functions that programs may call, written in Python; `registry` lists them."""

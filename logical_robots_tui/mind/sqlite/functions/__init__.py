"""The SQL functions that programs may call, in Python; `registry` lists them."""
